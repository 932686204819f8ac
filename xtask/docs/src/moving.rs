//! Moving pictures: the demo scene once around in several styles, as short animated WebP files. Pages ask for them by marks:
//! `<!-- moving: cartoon -->` for one, `<!-- moving -->` for all beside each other. Who wants less motion sees a still.

use crate::error::{Error, Result};
use crate::page::{Page, to_top};
use crate::studio::{self, finish, small};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// A moving picture.
struct Turn {
    id: &'static str,
    style: &'static str,
    label: &'static str,
}

const TURNS: [Turn; 3] = [
    Turn { id: "cartoon", style: "cartoon", label: "Cartoon" },
    Turn { id: "oil_paint", style: "oil_paint", label: "Oil paint" },
    Turn { id: "blueprint", style: "blueprint", label: "Blueprint" },
];

/// Most bytes of one.
const MOST: u64 = 400_000;

/// Pictures a second.
const RATE: &str = "10";

/// Options of the encoder: as small as lines stand.
const ENCODER: &str = "-c:v libwebp_anim -quality 25";

/// The scene that is turned, and the frames that are made of it.
pub struct Stage<'a> {
    /// The sample host.
    pub host: &'a Path,
    /// The demo scene.
    pub scene: &'a Path,
    /// A folder for what is in between.
    pub scratch: &'a Path,
    /// Number of frames.
    pub frames: u32,
    /// Size of the frames.
    pub size: (u32, u32),
}

/// Puts moving pictures in the place of a page's marks, which are lines of their own.
///
/// # Errors
/// [`Error::Page`] with a mark that names none.
pub fn fill(page: &mut Page) -> Result<()> {
    let top = to_top(&page.path);
    let mut text = String::new();
    for line in page.text.split_inclusive('\n') {
        let id = line.trim_end().strip_prefix("<!-- moving").and_then(|rest| rest.strip_suffix(" -->"));
        match id.map(|id| id.trim_start_matches(": ")) {
            Some("") => {
                let all: String = TURNS.iter().map(|turn| shown(turn, &top)).collect();
                let _ = writeln!(text, "<div class=\"row\">{all}</div>");
            }
            Some(id) => {
                let known = TURNS.iter().find(|turn| turn.id == id);
                let turn = known.ok_or_else(|| Error::page(&page.path, format!("nothing moves as {id}")))?;
                let _ = writeln!(text, "{}", shown(turn, &top));
            }
            None => text.push_str(line),
        }
    }
    page.text = text;
    Ok(())
}

fn shown(turn: &Turn, top: &str) -> String {
    let place = format!("{top}pictures/moving-{}", turn.id);
    format!(
        "<figure><picture><source media=\"(prefers-reduced-motion: reduce)\" srcset=\"{place}.jpg\"><img \
         src=\"{place}.webp\" alt=\"The demo scene once around: {}\" loading=\"lazy\"></picture>\
         <figcaption>{}</figcaption></figure>",
        turn.label, turn.label
    )
}

/// Makes all moving pictures and their stills.
///
/// # Errors
/// What cannot be rendered or filtered, and a file that is too large.
pub fn make(stage: &Stage<'_>, out: &Path) -> Result<()> {
    let frames = stage.scratch.join("turn.####.exr");
    let (width, height) = stage.size;
    let mut render = Command::new(stage.host);
    render.arg("render").arg(stage.scene).arg(&frames).args(["--turntable", "--quiet"]);
    render.args(["--size", &format!("{width}x{height}"), "--frames", &stage.frames.to_string()]);
    finish(&mut render)?;
    // Styles of one frame each fill a core.
    std::thread::scope(|scope| {
        let made: Vec<_> =
            TURNS.iter().map(|turn| scope.spawn(|| turned(stage, turn, &frames, out))).collect();
        made.into_iter().try_for_each(|made| {
            made.join().unwrap_or_else(|_| Err(Error::page(out.display(), "a moving picture panicked")))
        })
    })
}

fn turned(stage: &Stage<'_>, turn: &Turn, frames: &Path, out: &Path) -> Result<()> {
    let apply = |from: &Path, to: &Path, more: &[&str]| {
        let mut command = Command::new(stage.host);
        command.arg("apply").arg(turn.style).arg(from).arg(to).args(["--backend", "cpu", "--threads", "1"]);
        finish(command.arg("--quiet").args(more))
    };
    let moving = out.join(format!("moving-{}.webp", turn.id));
    apply(frames, &moving, &["--fps", RATE, "--encode", ENCODER])?;
    let size = std::fs::metadata(&moving).map_err(Error::at(&moving))?.len();
    if size > MOST {
        return Err(Error::page(moving.display(), format!("has {size} bytes, and may have {MOST}")));
    }
    let still = stage.scratch.join(format!("moving-{}.png", turn.id));
    apply(&stage.scratch.join("turn.0001.exr"), &still, &[])?;
    small(&still, &out.join(format!("moving-{}.jpg", turn.id)), studio::WIDEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_moving_pictures_with_a_still() {
        let (path, title) = ("a/b".to_owned(), "B".to_owned());
        let text = "<!-- moving: cartoon -->\n\n<!-- moving -->\n\na `<!-- moving -->` of text\n".to_owned();
        let mut page = Page { path, title, part: "", text, document: None };
        fill(&mut page).unwrap();
        assert_eq!(page.text.matches("../pictures/moving-cartoon.webp").count(), 2);
        assert_eq!(page.text.matches("prefers-reduced-motion").count(), 1 + TURNS.len());
        assert_eq!(page.text.matches("<!--").count(), 1, "{}", page.text);
        page.text = "<!-- moving: moon -->\n".to_owned();
        assert!(fill(&mut page).is_err());
        for turn in &TURNS {
            isophote::registry::find(turn.style).unwrap();
        }
    }
}
