//! Reading of the frames that are shown: sequences and videos that are open, each with its thread.

use std::sync::Arc;

use super::document::Document;
use crate::state::document::Frames;
use crate::state::document::frame::Frame;
use crate::state::playback::Playback;
use isophote_files::error::Result;

/// Frames that there are, and the one that is wanted when it has been read.
pub type Read = (Frames, Option<Result<Arc<Frame>>>);

/// The documents whose frames are read.
#[derive(Debug, Default)]
pub struct Reader {
    documents: Vec<Document>,
}

impl Reader {
    /// Reads the frames of a document from when it is shown on.
    pub fn extend(&mut self, document: Option<Document>) {
        self.documents.extend(document.filter(|document| document.frames().is_some()));
    }

    /// Frames of what is shown, of which those are read next that it wants. All other documents are closed.
    pub fn follow(&mut self, shown: Option<&Playback>) -> Option<Read> {
        self.documents
            .retain(|document| shown.is_some_and(|shown| Arc::ptr_eq(shown.info(), document.info())));
        let (document, shown) = (self.documents.first()?, shown?);
        document.play(i64::from(shown.playing));
        Some((document.frames()?, document.frame(shown.number())))
    }
}
