//! What the viewer shows, apart from window and device: scene, camera, time, styles, statistics.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::error::Result;
use crate::loader::Library;
use crate::render::background::Background;
use crate::render::look::Look;
use crate::scene::Scene;
use crate::scene::camera::{self, Direction, Framing, Orbit, View};
use crate::scene::pose::Pose;
use crate::stylize::lengths::Lengths;
use crate::stylize::style::{Setting, Style};

/// The style that leaves frames as they were rendered.
const PLAIN: &str = "none";

/// State that outlives a lost device.
pub struct Viewer {
    /// The dynamic library.
    pub library: Library,
    /// The scene.
    pub scene: Scene,
    /// Where everything stands now.
    pub pose: Pose,
    /// Sun and sky.
    pub look: Look,
    /// What is behind the scene.
    pub background: Background,
    /// Whether the scene casts its shadow on an invisible ground.
    pub ground: bool,
    /// Styles in the order of the keys 1, 2, ...
    pub styles: Vec<String>,
    /// Parameters for the styles that have them.
    pub settings: Vec<Setting>,
    lengths: Option<Lengths>,
    /// Size of the window in pixels.
    pub size: (u32, u32),
    /// Whether time passes.
    pub playing: bool,
    /// Name of the adapter.
    pub adapter: String,
    name: String,
    current: usize,
    framing: Framing,
    orbit: Orbit,
    file_camera: Option<usize>,
    from_file: bool,
    time: f32,
    ticked: Instant,
    frames: u32,
    stretches: Vec<Stretch>,
    limit: Option<u32>,
}

/// Frames of one style and size, for the report.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The style.
    pub style: String,
    /// Size of the window.
    pub size: (u32, u32),
    /// Time of each frame.
    pub times: Vec<Duration>,
}

/// What a viewer shows besides the scene.
#[derive(Clone, Debug)]
pub struct Options {
    /// Name of the scene in the window's title.
    pub name: String,
    /// Styles in the order of the keys 1, 2, ..., as [`usable_styles`] returns them.
    pub styles: Vec<String>,
    /// Parameters for the styles that have them.
    pub settings: Vec<Setting>,
    /// What lengths mean; none: what presets say.
    pub lengths: Option<Lengths>,
    /// Size of the window in pixels.
    pub size: (u32, u32),
    /// How the default camera frames the scene.
    pub framing: Framing,
    /// Node of the camera of the file that is looked through at first; the default camera otherwise.
    pub camera: Option<usize>,
    /// Where the sun is, seen from the camera, if not where it usually is.
    pub light: Option<Direction>,
    /// What is behind the scene.
    pub background: Background,
    /// Whether the scene casts its shadow on an invisible ground.
    pub ground: bool,
    /// Closes the window after so many frames.
    pub frames: Option<u32>,
}

/// The styles `wanted`, or no style and every node of the group styles where none is; checked to be usable.
///
/// # Errors
/// As [`Style::load`]; also for a parameter that no style has.
pub fn usable_styles(library: &Library, wanted: &[String], settings: &[Setting]) -> Result<Vec<String>> {
    let mut styles = wanted.to_vec();
    if styles.is_empty() {
        styles.push(PLAIN.to_owned());
        let catalogue = library.catalogue().map_err(|e| e.at("the library", "install it again"))?;
        styles.extend(catalogue.nodes.iter().filter(|n| n.group == "styles").map(|n| n.id.to_owned()));
    }
    let loaded: Vec<Style> =
        styles.iter().filter(|s| *s != PLAIN).map(|s| Style::load(library, s, &[])).collect::<Result<_>>()?;
    for setting in settings {
        let mut refusals = loaded.iter().map(|s| s.set(setting));
        if let Some(refusal) = refusals.next().filter(|_| !refusals.any(|r| r.is_ok())) {
            refusal?;
        }
    }
    Ok(styles)
}

impl Viewer {
    /// A viewer of `scene`, at rest.
    pub fn new(library: Library, scene: Scene, options: Options) -> Self {
        let Options {
            name,
            styles,
            settings,
            lengths,
            size,
            framing,
            camera,
            light,
            background,
            ground,
            frames,
        } = options;
        let pose = Pose::at_rest(&scene);
        let orbit = Orbit::framing(&scene, size.0 as f32 / size.1 as f32, framing);
        let view = camera.and_then(|node| View::from_node(&scene, &pose, node));
        let view = view.unwrap_or_else(|| orbit.view());
        let look = Look::for_scene(&scene, &pose, &view, light, background.environment());
        let file_camera = camera.or_else(|| camera::file_camera(&scene));
        Self {
            framing,
            orbit,
            from_file: camera.is_some(),
            playing: !scene.animations.is_empty(),
            library,
            pose,
            look,
            background,
            ground,
            styles,
            settings,
            lengths,
            size,
            adapter: String::new(),
            name,
            current: 0,
            file_camera,
            scene,
            time: 0.0,
            ticked: Instant::now(),
            frames: 0,
            stretches: Vec::new(),
            limit: frames,
        }
    }

    /// The style that is shown.
    pub fn style(&self) -> &str {
        &self.styles[self.current]
    }

    /// A style with the parameters that it has of those that were set; nothing for the plain one.
    ///
    /// # Errors
    /// As [`Style::load`].
    pub fn load(&self, style: &str) -> Result<Option<Style>> {
        if style == PLAIN {
            return Ok(None);
        }
        let mut style = Style::load(&self.library, style, &[])?;
        style.lengths = self.lengths.unwrap_or(style.lengths);
        for setting in &self.settings {
            // That some style takes it was made sure of at the start.
            let _ = style.set(setting);
        }
        Ok(Some(style))
    }

    /// Position of the style after this one.
    pub fn next_style(&self) -> usize {
        (self.current + 1) % self.styles.len()
    }

    /// Another style is shown from now on.
    pub fn switched(&mut self, index: usize) {
        self.current = index;
        self.frames = 0;
    }

    /// The window has another size from now on.
    pub fn resized(&mut self, size: (u32, u32)) {
        if size != self.size {
            self.size = size;
            self.frames = 0;
        }
    }

    /// Starts or stops the animation.
    pub fn toggle_playing(&mut self) {
        self.playing = !self.playing && !self.scene.animations.is_empty();
        self.ticked = Instant::now();
    }

    /// Frames the whole scene.
    pub fn frame_all(&mut self) {
        let aspect = self.size.0 as f32 / self.size.1.max(1) as f32;
        self.orbit = Orbit::framing(&self.scene, aspect, self.framing);
        self.from_file = false;
    }

    /// Looks through the file's camera, where it has one.
    pub fn use_file_camera(&mut self) {
        self.from_file = self.file_camera.is_some();
    }

    /// The camera that the mouse turns. It takes over from where the file's camera stands.
    pub fn orbit(&mut self) -> &mut Orbit {
        if self.from_file
            && let Some(view) =
                self.file_camera.and_then(|node| View::from_node(&self.scene, &self.pose, node))
        {
            let offset = view.eye() - self.orbit.target;
            let distance = offset.length();
            if distance.is_finite() && distance > 0.0 {
                self.orbit.distance = distance;
                self.orbit.azimuth = offset.x.atan2(offset.z);
                self.orbit.elevation = (offset.y / distance).clamp(-1.0, 1.0).asin();
            }
        }
        self.from_file = false;
        &mut self.orbit
    }

    /// Lets time pass and says where the camera is.
    pub fn advance(&mut self) -> View {
        if self.playing {
            self.time += self.ticked.elapsed().as_secs_f32();
            let animation = (!self.scene.animations.is_empty()).then_some(0);
            self.pose.update(&self.scene, animation, self.time);
        }
        self.ticked = Instant::now();
        let from_file = self.file_camera.filter(|_| self.from_file);
        from_file
            .and_then(|node| View::from_node(&self.scene, &self.pose, node))
            .unwrap_or_else(|| self.orbit.view())
    }

    /// A frame was shown.
    pub fn count(&mut self, time: Duration) {
        self.frames += 1;
        let style = self.styles[self.current].clone();
        match self.stretches.last_mut() {
            Some(last) if self.frames > 1 && last.style == style => last.times.push(time),
            _ => self.stretches.push(Stretch { style, size: self.size, times: vec![time] }),
        }
    }

    /// Whether all frames that were asked for have been shown.
    pub fn finished(&self) -> bool {
        self.limit.is_some_and(|limit| {
            self.stretches.iter().map(|s| s.times.len()).sum::<usize>() >= limit as usize
        })
    }

    /// Title of the window: scene, style, frames shown since the last switch, time of the last one.
    pub fn title(&self, time: Option<Duration>) -> String {
        let style = Path::new(self.style()).file_stem().map_or(self.style().into(), |s| s.to_string_lossy());
        match time {
            Some(time) => format!(
                "{} - {style} - frame {} - {:.1} ms",
                self.name,
                self.frames,
                time.as_secs_f64() * 1e3
            ),
            None => format!("{} - {style}", self.name),
        }
    }

    /// What was shown, in order.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }
}
