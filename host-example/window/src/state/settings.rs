//! Settings that the window remembers from one time to the next: its size, folders, recent files, the last look.

use std::path::{Path, PathBuf};
use std::{env, fs};

use serde::{Deserialize, Serialize};

use isophote_files::error::{Error, Result};
use isophote_files::files::{self, Existing};

/// Names the file instead of the usual place.
const PLACE: &str = "ISOPHOTE_SETTINGS";
/// Most recent files.
const MOST_RECENT: usize = 12;
/// Most folders of looks.
const MOST_FOLDERS: usize = 64;
/// Most favourite looks.
const MOST_FAVOURITES: usize = 500;
/// Most bytes of the file.
const MOST_BYTES: u64 = 1 << 20;

/// Settings that are remembered. What a file does not say is as it is for the first time.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default)]
pub struct Settings {
    /// Size of the window in pixels.
    pub window: Option<(u32, u32)>,
    /// Files that were open, the last one first.
    pub recent: Vec<PathBuf>,
    /// Folder where scenes and pictures were chosen last.
    pub folder: Option<PathBuf>,
    /// Folder where looks were chosen last.
    pub look_folder: Option<PathBuf>,
    /// Folders whose looks are offered.
    pub look_folders: Vec<PathBuf>,
    /// The look that was shown last.
    pub look: Option<PathBuf>,
    /// True where the panel is hidden.
    pub panel_hidden: bool,
    /// Width of the panel in points, where it is another than usual.
    pub panel_width: Option<f32>,
    /// Favourite looks, by the names that they are opened by.
    pub favourites: Vec<PathBuf>,
    /// True where histograms are shown.
    pub shows_histogram: bool,
    #[serde(skip)]
    place: Option<PathBuf>,
}

impl Settings {
    /// Reads what is remembered; a file that cannot be read counts for nothing, which is the error beside.
    pub fn read() -> (Self, Option<Error>) {
        let Some(place) = place() else { return (Self::default(), None) };
        let (mut settings, problem) = match Self::read_from(&place) {
            Ok(settings) => (settings, None),
            Err(problem) => (Self::default(), Some(problem)),
        };
        settings.place = Some(place);
        (settings, problem)
    }

    fn read_from(place: &Path) -> Result<Self> {
        let unusable = |problem: String| {
            Error::file(place, format!("is not usable: {problem}"), "the window begins as for the first time")
        };
        match fs::metadata(place) {
            Err(_) => return Ok(Self::default()),
            Ok(data) if data.len() > MOST_BYTES => return Err(unusable("it is too large".into())),
            Ok(_) => {}
        }
        let text = fs::read_to_string(place).map_err(|e| unusable(e.to_string()))?;
        let mut settings: Self = serde_json::from_str(&text).map_err(|e| unusable(e.to_string()))?;
        settings.recent.truncate(MOST_RECENT);
        settings.favourites.truncate(MOST_FAVOURITES);
        settings.window = settings.window.filter(|(width, height)| *width > 0 && *height > 0);
        Ok(settings)
    }

    /// Writes what is remembered.
    ///
    /// # Errors
    /// [`Error::Input`] and [`Error::Failure`] when the file cannot be written.
    pub fn write(&self) -> Result<()> {
        let Some(place) = &self.place else { return Ok(()) };
        if let Some(folder) = place.parent() {
            fs::create_dir_all(folder)
                .map_err(|e| Error::file(folder, format!("cannot be made: {e}"), "make the folder"))?;
        }
        let text = serde_json::to_string_pretty(self).unwrap_or_default();
        files::write_bytes(place, Existing::Replace, text.as_bytes())
    }

    /// Offers the looks of a folder from now on.
    pub fn add_look_folder(&mut self, folder: &Path) {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        if !self.look_folders.contains(&folder) {
            self.look_folders.push(folder);
            self.look_folders.truncate(MOST_FOLDERS);
        }
    }

    /// Offers them no more; the files stay.
    pub fn remove_look_folder(&mut self, folder: &Path) {
        self.look_folders.retain(|known| known != folder);
    }

    /// Makes a look a favourite, or no more.
    pub fn toggle_favourite(&mut self, source: &Path) {
        let before = self.favourites.len();
        self.favourites.retain(|known| known != source);
        if self.favourites.len() == before && before < MOST_FAVOURITES {
            self.favourites.push(source.to_owned());
        }
    }

    /// Folder where looks are saved: where one was last, or beside this file.
    pub fn place_for_looks(&self) -> PathBuf {
        let own = || Some(self.place.as_deref()?.parent()?.join("looks"));
        self.look_folder.clone().or_else(own).unwrap_or_default()
    }

    /// Folder where pictures that come with the program are written: beside this file.
    pub fn place_for_samples(&self) -> PathBuf {
        let own = self.place.as_deref().and_then(Path::parent).map(|folder| folder.join("pictures"));
        own.unwrap_or_else(|| env::temp_dir().join("isophote-pictures"))
    }

    /// A file was opened.
    pub fn remember(&mut self, file: &Path) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        self.recent.retain(|known| *known != file);
        self.folder = file.parent().map(Path::to_owned);
        self.recent.insert(0, file);
        self.recent.truncate(MOST_RECENT);
    }
}

/// Path of the file: where the environment says, or where programs of the system keep such files.
fn place() -> Option<PathBuf> {
    let named = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if let Some(place) = named(PLACE) {
        return Some(place);
    }
    let folder = if cfg!(windows) {
        named("APPDATA")?
    } else if cfg!(target_os = "macos") {
        named("HOME")?.join("Library/Application Support")
    } else {
        named("XDG_CONFIG_HOME")
            .filter(|path| path.is_absolute())
            .or_else(|| Some(named("HOME")?.join(".config")))?
    };
    Some(folder.join("isophote").join("view.json"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_what_is_broken_counts_for_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("deep").join("view.json");
        let mut settings = Settings { place: Some(place.clone()), ..Settings::default() };
        settings.window = Some((900, 500));
        settings.panel_width = Some(412.5);
        for folder in ["/looks", "/more", "/looks"] {
            settings.add_look_folder(Path::new(folder));
        }
        // With the letter of a disk, on Windows.
        let [looks, more] = ["/looks", "/more"].map(|folder| std::path::absolute(folder).unwrap());
        settings.remove_look_folder(&more);
        assert_eq!(settings.place_for_looks(), place.with_file_name("looks"));
        for number in 0..20 {
            settings.remember(Path::new(&format!("/pictures/{number}.png")));
        }
        settings.remember(Path::new("/pictures/12.png"));
        for look in ["look:noir", "cartoon", "look:noir"] {
            settings.toggle_favourite(Path::new(look));
        }
        settings.write().unwrap();
        let read = Settings::read_from(&place).unwrap();
        assert_eq!((read.window, read.recent.len()), (Some((900, 500)), MOST_RECENT));
        assert_eq!(read.panel_width, Some(412.5));
        assert_eq!(read.recent[0], std::path::absolute("/pictures/12.png").unwrap());
        assert_eq!(read.look_folders, [looks]);
        assert_eq!(read.favourites, [Path::new("cartoon")]);
        assert_eq!(read.folder.as_deref(), Some(&*std::path::absolute("/pictures").unwrap()));
        for broken in ["", "{", r#"{"window": "large"}"#] {
            fs::write(&place, broken).unwrap();
            assert!(Settings::read_from(&place).is_err(), "{broken}");
        }
        fs::write(&place, r#"{"later": 1, "window": [0, 5]}"#).unwrap();
        assert_eq!(Settings::read_from(&place).unwrap(), Settings::default());
        assert!(Settings::read_from(Path::new("/nowhere/at/all.json")).is_ok());
    }
}
