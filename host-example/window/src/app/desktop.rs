//! The window as desktops know it: the application that it belongs to, its icon, and whether files can be dropped on it.

use image::ImageFormat;
use winit::event_loop::ActiveEventLoop;
use winit::window::{Icon, WindowAttributes};

/// The icon, as `isophote-icons` draws it.
const ICON: &[u8] = include_bytes!("../../icon/128.png");

/// Name of the application: that of its desktop entry, by which desktops find its name and icon.
#[cfg(target_os = "linux")]
const APPLICATION: &str = "org.isophote.Isophote";

/// The icon of the window; none where it cannot be had, which is no reason to do without a window.
pub fn icon() -> Option<Icon> {
    let picture = image::load_from_memory_with_format(ICON, ImageFormat::Png).ok()?.into_rgba8();
    let (width, height) = picture.dimensions();
    Icon::from_rgba(picture.into_raw(), width, height).ok()
}

/// A window of the application.
pub fn named(attributes: WindowAttributes) -> WindowAttributes {
    #[cfg(target_os = "linux")]
    let attributes = {
        use winit::platform::{wayland, x11};

        let x11 = x11::WindowAttributesExtX11::with_name(attributes, APPLICATION, "isophote");
        wayland::WindowAttributesExtWayland::with_name(x11, APPLICATION, "isophote")
    };
    attributes
}

/// True where files can be dropped on windows. Under Wayland nobody tells the program of it.
pub fn takes_drops(event_loop: &ActiveEventLoop) -> bool {
    #[cfg(target_os = "linux")]
    {
        use winit::platform::wayland::ActiveEventLoopExtWayland;

        !event_loop.is_wayland()
    }
    #[cfg(not(target_os = "linux"))]
    {
        let _ = event_loop;
        true
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_icon_can_be_read() {
        assert!(super::icon().is_some());
    }
}
