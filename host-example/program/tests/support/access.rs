//! The window as programs see it that read windows aloud: over AT-SPI, on buses of the test's own.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use serde::de::DeserializeOwned;
use zbus::zvariant::{DynamicType, ObjectPath, OwnedObjectPath, OwnedValue, Type, Value};
use zbus::{Connection, block_on, connection};

use super::window::{Display, Running, Window};

const ACCESSIBLE: &str = "org.a11y.atspi.Accessible";
const ROOT: &str = "/org/a11y/atspi/accessible/root";
/// Bits of states, as AT-SPI numbers them.
const STATES: [(u32, &str); 8] = [
    (4, "checked"),
    (7, "editable"),
    (8, "enabled"),
    (11, "focusable"),
    (12, "focused"),
    (16, "modal"),
    (20, "pressed"),
    (23, "selected"),
];

/// Numbers of roles, as AT-SPI has them.
const ROLES: [(u32, &str); 19] = [
    (7, "check box"),
    (11, "combo box"),
    (16, "dialog"),
    (23, "window"),
    (27, "image"),
    (29, "label"),
    (31, "list"),
    (33, "menu"),
    (35, "menu item"),
    (39, "panel"),
    (42, "progress bar"),
    (43, "button"),
    (51, "slider"),
    (52, "spin button"),
    (54, "status"),
    (62, "toggle button"),
    (75, "application"),
    (79, "entry"),
    (88, "link"),
];

/// A session bus on which programs ask windows what they show.
pub struct Bus {
    _daemon: Running,
    /// As `DBUS_SESSION_BUS_ADDRESS` has it.
    pub address: String,
    session: Connection,
    access: Connection,
}

/// A control as it is told.
#[derive(Clone, Debug)]
pub struct Control {
    bus: String,
    path: OwnedObjectPath,
    /// Role in the words of AT-SPI.
    pub role: String,
    /// Name that is read aloud.
    pub name: String,
    /// States, of those that tests ask for.
    pub states: Vec<&'static str>,
}

impl Control {
    /// True where it is in a state.
    pub fn is(&self, state: &str) -> bool {
        self.states.contains(&state)
    }

    /// Role and name in one line.
    pub fn line(&self) -> String {
        format!("{} '{}'", self.role, self.name)
    }
}

impl Bus {
    /// A bus for the windows of a display; nothing where the test cannot be made, which is not so on machines that test.
    pub fn open(display: &Display, folder: &Path) -> Option<Self> {
        let opened = Self::try_open(display, folder);
        if opened.is_none() {
            assert!(
                std::env::var_os("CI").is_none(),
                "D-Bus and AT-SPI are needed: apt install dbus-daemon at-spi2-core"
            );
            eprintln!("SKIPPED: no dbus-daemon or at-spi2-core");
        }
        opened
    }

    fn try_open(display: &Display, folder: &Path) -> Option<Self> {
        let mut daemon = Command::new("dbus-daemon")
            .args(["--session", "--nofork", "--print-address=1"])
            .arg(format!("--address=unix:path={}", folder.join("bus").display()))
            .env("DISPLAY", &display.name)
            .env("XDG_RUNTIME_DIR", folder)
            .env("GSETTINGS_BACKEND", "memory")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .ok()?;
        let mut address = String::new();
        BufReader::new(daemon.stdout.take()?).read_line(&mut address).ok()?;
        let daemon = Running(daemon);
        let address = address.trim().to_owned();
        let connect = |address: &str| block_on(connection::Builder::address(address).ok()?.build()).ok();
        let session = connect(&address)?;
        let reply = session.call_method(
            Some("org.a11y.Bus"),
            "/org/a11y/bus",
            Some("org.a11y.Bus"),
            "GetAddress",
            &(),
        );
        let access: String = block_on(reply).ok()?.body().deserialize().ok()?;
        let bus = Self { _daemon: daemon, address, session, access: connect(&access)? };
        for name in ["IsEnabled", "ScreenReaderEnabled"] {
            let place = ("org.a11y.Bus", "/org/a11y/bus");
            bus.set(&bus.session, place, "org.a11y.Status", name, true.into());
        }
        Some(bus)
    }

    fn set(&self, on: &Connection, (bus, path): (&str, &str), interface: &str, name: &str, value: Value<'_>) {
        let body = (interface, name, value);
        let reply = on.call_method(Some(bus), path, Some("org.freedesktop.DBus.Properties"), "Set", &body);
        block_on(reply).expect("it can be set");
    }

    /// Answer of an object, unless it is gone.
    fn ask<R: DeserializeOwned + Type>(
        &self,
        (bus, path): (&str, &ObjectPath<'_>),
        interface: &str,
        method: &str,
        body: &(impl serde::Serialize + DynamicType),
    ) -> Option<R> {
        let reply = block_on(self.access.call_method(Some(bus), path, Some(interface), method, body)).ok()?;
        reply.body().deserialize().ok()
    }

    fn property(&self, object: (&str, &ObjectPath<'_>), interface: &str, name: &str) -> Option<OwnedValue> {
        self.ask(object, "org.freedesktop.DBus.Properties", "Get", &(interface, name))
    }

    /// All that the program shows, in the order in which it is read; nothing while it shows nothing.
    pub fn controls(&self) -> Vec<Control> {
        let root = ObjectPath::from_static_str_unchecked(ROOT);
        let mut controls = Vec::new();
        self.collect(("org.a11y.atspi.Registry", &root), &mut controls);
        controls
    }

    fn collect(&self, object: (&str, &ObjectPath<'_>), controls: &mut Vec<Control>) {
        let children: Vec<(String, OwnedObjectPath)> =
            self.ask(object, ACCESSIBLE, "GetChildren", &()).unwrap_or_default();
        for (bus, path) in children {
            let child = (bus.as_str(), &*path);
            let Some(number) = self.ask::<u32>(child, ACCESSIBLE, "GetRole", &()) else { continue };
            let role = ROLES.iter().find(|(known, _)| *known == number);
            let role = role.map_or_else(|| format!("role {number}"), |(_, name)| (*name).to_owned());
            let name = self.property(child, ACCESSIBLE, "Name").and_then(|name| name.try_into().ok());
            let bits: Vec<u32> = self.ask(child, ACCESSIBLE, "GetState", &()).unwrap_or_default();
            let is_set =
                |bit: u32| bits.get(bit as usize / 32).is_some_and(|word| word >> (bit % 32) & 1 == 1);
            let states = STATES.iter().filter(|(bit, _)| is_set(*bit)).map(|(_, name)| *name).collect();
            let name = name.unwrap_or_default();
            controls.push(Control { bus: bus.clone(), path: path.clone(), role, name, states });
            self.collect(child, controls);
        }
    }

    /// The control of a role and a name, once it is there.
    pub fn find(&self, window: &mut Window<'_>, role: &str, name: &str) -> Control {
        let mut found = None;
        window.wait_for(&format!("{role} '{name}'"), |_| {
            found = self.controls().into_iter().find(|control| control.role == role && control.name == name);
            found.is_some()
        });
        found.expect("it was waited for")
    }

    /// Presses a control.
    pub fn press(&self, control: &Control) {
        let object = (control.bus.as_str(), &*control.path);
        assert_eq!(
            self.ask(object, "org.a11y.atspi.Action", "DoAction", &(0_i32,)),
            Some(true),
            "{control:?}"
        );
    }

    /// Gives a control the focus.
    pub fn focus(&self, control: &Control) {
        let object = (control.bus.as_str(), &*control.path);
        assert_eq!(self.ask(object, "org.a11y.atspi.Component", "GrabFocus", &()), Some(true), "{control:?}");
    }

    /// Least, present and greatest value of a control that has one.
    pub fn value(&self, control: &Control) -> [f64; 3] {
        let object = (control.bus.as_str(), &*control.path);
        ["MinimumValue", "CurrentValue", "MaximumValue"].map(|name| {
            let value = self.property(object, "org.a11y.atspi.Value", name);
            let value = value.and_then(|value| f64::try_from(value).ok());
            value.unwrap_or_else(|| panic!("{control:?} has no {name}"))
        })
    }

    /// Gives a control a value.
    pub fn set_value(&self, control: &Control, value: f64) {
        let place = (control.bus.as_str(), control.path.as_str());
        self.set(&self.access, place, "org.a11y.atspi.Value", "CurrentValue", value.into());
    }

    /// Text that a field has.
    pub fn text(&self, control: &Control) -> String {
        let object = (control.bus.as_str(), &*control.path);
        self.ask(object, "org.a11y.atspi.Text", "GetText", &(0_i32, -1_i32)).expect("a field of text")
    }

    /// Place of a control in the window: left, upper, right and lower border.
    pub fn place(&self, control: &Control) -> [i32; 4] {
        let object = (control.bus.as_str(), &*control.path);
        let found: Option<(i32, i32, i32, i32)> =
            self.ask(object, "org.a11y.atspi.Component", "GetExtents", &(1_u32,));
        let (x, y, width, height) = found.expect("a place");
        [x, y, x + width, y + height]
    }

    /// The control that has the focus; the window has it where none does.
    pub fn focused(&self) -> Option<Control> {
        self.controls().into_iter().find(|control| control.is("focused") && control.role != "window")
    }
}
