//! Cameras of a real Bevy application, stylized on a graphics device.

mod cameras;
mod looks;
mod pictures;
mod stage;
