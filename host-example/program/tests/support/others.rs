//! Acts of other programs on a window: files dropped on it, by the source's side of XDND, version 5, windows that
//! cover it, and being asked to close.

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::CURRENT_TIME;
use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

/// This only ends a test that hangs.
const PATIENCE: Duration = Duration::from_secs(60);
/// Place on the screen where files are dropped.
const PLACE: [u32; 2] = [60, 90];

type X11Result<T> = Result<T, Box<dyn std::error::Error>>;

/// Drops files on a window, and says whether it has taken them.
pub fn drop_files(display: &str, window: &str, files: &[&Path]) -> bool {
    DragSource::open(display, window).and_then(|source| source.drop_list(&list(files))).expect("an X server")
}

/// The program that files are dragged out of.
struct DragSource {
    connection: RustConnection,
    own: Window,
    target: Window,
}

impl DragSource {
    fn open(display: &str, window: &str) -> X11Result<Self> {
        let (connection, screen) = RustConnection::connect(Some(display))?;
        let own = connection.generate_id()?;
        let root = connection.setup().roots[screen].root;
        let (class, aux) = (WindowClass::INPUT_OUTPUT, CreateWindowAux::new());
        connection.create_window(0, own, root, 0, 0, 1, 1, 0, class, 0, &aux)?.check()?;
        Ok(Self { connection, own, target: window.parse()? })
    }

    fn atom(&self, name: &str) -> X11Result<Atom> {
        Ok(self.connection.intern_atom(false, name.as_bytes())?.reply()?.atom)
    }

    fn tell(&self, what: &str, words: [u32; 4]) -> X11Result<()> {
        let [a, b, c, d] = words;
        let event = ClientMessageEvent::new(32, self.target, self.atom(what)?, [self.own, a, b, c, d]);
        self.connection.send_event(false, self.target, EventMask::NO_EVENT, event)?;
        Ok(self.connection.flush()?)
    }

    /// Drags over the window, hands the list over when it is asked for, and lets go.
    fn drop_list(&self, list: &str) -> X11Result<bool> {
        let (selection, kind) = (self.atom("XdndSelection")?, self.atom("text/uri-list")?);
        let (status, finished) = (self.atom("XdndStatus")?, self.atom("XdndFinished")?);
        self.connection.set_selection_owner(self.own, selection, CURRENT_TIME)?;
        self.tell("XdndEnter", [5 << 24, kind, 0, 0])?;
        let copy = self.atom("XdndActionCopy")?;
        self.tell("XdndPosition", [0, PLACE[0] << 16 | PLACE[1], CURRENT_TIME, copy])?;
        let (started, mut accepted, mut handed) = (Instant::now(), false, false);
        while started.elapsed() < PATIENCE {
            match self.connection.poll_for_event()? {
                Some(Event::SelectionRequest(request)) => {
                    self.hand_over(&request, kind, list)?;
                    handed = true;
                }
                Some(Event::ClientMessage(message)) if message.type_ == status => {
                    accepted = message.data.as_data32()[1] & 1 == 1;
                    if !accepted {
                        return Ok(false);
                    }
                }
                Some(Event::ClientMessage(message)) if message.type_ == finished => {
                    return Ok(message.data.as_data32()[1] & 1 == 1);
                }
                Some(_) => continue,
                None => std::thread::sleep(Duration::from_millis(5)),
            }
            if accepted && handed {
                self.tell("XdndDrop", [0, CURRENT_TIME, 0, 0])?;
                (accepted, handed) = (false, false);
            }
        }
        Err("the window does not answer".into())
    }

    fn hand_over(&self, request: &SelectionRequestEvent, kind: Atom, list: &str) -> X11Result<()> {
        let SelectionRequestEvent { requestor, selection, target, property, time, .. } = *request;
        let property = if target == kind { property } else { AtomEnum::NONE.into() };
        if target == kind {
            self.connection.change_property8(
                PropMode::REPLACE,
                requestor,
                property,
                kind,
                list.as_bytes(),
            )?;
        }
        let answer = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time,
            requestor,
            selection,
            target,
            property,
        };
        self.connection.send_event(false, requestor, EventMask::NO_EVENT, answer)?;
        Ok(self.connection.flush()?)
    }
}

/// Asks a window to close, as the button in its title does.
pub fn close(display: &str, window: &str) {
    let close = || -> X11Result<()> {
        let source = DragSource::open(display, window)?;
        let [protocols, delete] = [source.atom("WM_PROTOCOLS")?, source.atom("WM_DELETE_WINDOW")?];
        let event = ClientMessageEvent::new(32, source.target, protocols, [delete, CURRENT_TIME, 0, 0, 0]);
        source.connection.send_event(false, source.target, EventMask::NO_EVENT, event)?;
        // Waits until the server has it.
        source.connection.get_input_focus()?.reply()?;
        Ok(())
    };
    close().expect("an X server");
}

/// Files as addresses, one a line.
fn list(files: &[&Path]) -> String {
    let address = |file: &&Path| {
        let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/._-".contains(&byte);
        let letter = |byte: u8| match byte {
            byte if plain(byte) => char::from(byte).to_string(),
            byte => format!("%{byte:02X}"),
        };
        let path = file.to_str().expect("a path of letters");
        format!("file://{}\r\n", path.bytes().map(letter).collect::<String>())
    };
    files.iter().map(address).collect()
}

/// A window that covers the whole screen until it is dropped.
pub struct Cover(RustConnection);

impl Cover {
    /// Covers everything.
    pub fn open(display: &str) -> Self {
        let cover = || -> X11Result<Self> {
            let (connection, screen) = RustConnection::connect(Some(display))?;
            let root = &connection.setup().roots[screen];
            let (own, size) = (connection.generate_id()?, (root.width_in_pixels, root.height_in_pixels));
            let aux = CreateWindowAux::new().override_redirect(1).background_pixel(root.white_pixel);
            let class = WindowClass::INPUT_OUTPUT;
            connection.create_window(0, own, root.root, 0, 0, size.0, size.1, 0, class, 0, &aux)?.check()?;
            connection.map_window(own)?.check()?;
            Ok(Self(connection))
        };
        cover().expect("an X server")
    }
}

impl Drop for Cover {
    fn drop(&mut self) {
        // The server closes windows of those that leave.
        let _ = self.0.flush();
    }
}
