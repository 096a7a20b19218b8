//! Another client of the screen: one that drags a file over the window, and one that reads the
//! clipboard.
//!
//! The file manager's side of the X drag-and-drop protocol, version 5, and the requestor's of the
//! ICCCM's selections (section 2.4), for texts that fit into one property.

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_FROM_PARENT, CURRENT_TIME, NONE};

const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) struct Peer {
    connection: RustConnection,
    own: Window,
}

impl Peer {
    pub(crate) fn new(display: &str) -> Self {
        let (connection, screen) = RustConnection::connect(Some(display)).unwrap();
        let own = connection.generate_id().unwrap();
        let root = connection.setup().roots[screen].root;
        connection
            .create_window(
                0,
                own,
                root,
                0,
                0,
                1,
                1,
                0,
                WindowClass::INPUT_OUTPUT,
                COPY_FROM_PARENT,
                &CreateWindowAux::new(),
            )
            .unwrap();
        Self { connection, own }
    }

    fn atom(&self, name: &str) -> Atom {
        let cookie = self.connection.intern_atom(false, name.as_bytes());
        cookie.unwrap().reply().unwrap().atom
    }

    fn send(&self, to: Window, kind: &str, words: [u32; 5]) {
        let message = ClientMessageEvent::new(32, to, self.atom(kind), words);
        self.connection
            .send_event(false, to, EventMask::NO_EVENT, message)
            .unwrap();
        self.connection.flush().unwrap();
    }

    /// The first event that `wanted` takes.
    fn next<T>(&self, what: &str, mut wanted: impl FnMut(Event) -> Option<T>) -> T {
        let start = Instant::now();
        while start.elapsed() < PATIENCE {
            match self.connection.poll_for_event().unwrap() {
                Some(event) => {
                    if let Some(found) = wanted(event) {
                        return found;
                    }
                }
                None => std::thread::sleep(Duration::from_millis(5)),
            }
        }
        panic!("no {what} came");
    }

    /// Drags files to a place of the window and lets them go.
    pub(crate) fn drop_files(&self, window: Window, (x, y): (u32, u32), files: &[&Path]) {
        let lines = files
            .iter()
            .map(|file| format!("file://{}\r\n", file.display()));
        let list: String = lines.collect();
        let (selection, uris) = (self.atom("XdndSelection"), self.atom("text/uri-list"));
        self.connection
            .set_selection_owner(self.own, selection, CURRENT_TIME)
            .unwrap();
        self.send(window, "XdndEnter", [self.own, 5 << 24, uris, 0, 0]);
        let copy = self.atom("XdndActionCopy");
        let place = [self.own, 0, x << 16 | y, CURRENT_TIME, copy];
        self.send(window, "XdndPosition", place);
        self.hand_over("XdndStatus", &list);
        self.send(window, "XdndDrop", [self.own, 0, CURRENT_TIME, 0, 0]);
        self.hand_over("XdndFinished", &list);
    }

    /// Gives `list` to whoever asks for it, until the window sends `end`.
    fn hand_over(&self, end: &str, list: &str) {
        let end_atom = self.atom(end);
        self.next(end, |event| match event {
            Event::SelectionRequest(request) => {
                self.give(&request, list);
                None
            }
            Event::ClientMessage(message) => (message.type_ == end_atom).then_some(()),
            _ => None,
        });
    }

    fn give(&self, request: &SelectionRequestEvent, text: &str) {
        self.connection
            .change_property8(
                PropMode::REPLACE,
                request.requestor,
                request.property,
                request.target,
                text.as_bytes(),
            )
            .unwrap();
        let given = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: request.requestor,
            selection: request.selection,
            target: request.target,
            property: request.property,
        };
        self.connection
            .send_event(false, request.requestor, EventMask::NO_EVENT, given)
            .unwrap();
        self.connection.flush().unwrap();
    }

    /// The text in the clipboard, if anybody owns it.
    pub(crate) fn clipboard(&self) -> Option<String> {
        let (clipboard, text) = (self.atom("CLIPBOARD"), self.atom("UTF8_STRING"));
        let place = self.atom("FOVEAL_TEST");
        self.connection
            .convert_selection(self.own, clipboard, text, place, CURRENT_TIME)
            .unwrap();
        self.connection.flush().unwrap();
        let property = self.next("answer", |event| match event {
            Event::SelectionNotify(notice) => Some(notice.property),
            _ => None,
        });
        if property == NONE {
            return None;
        }
        let cookie =
            self.connection
                .get_property(true, self.own, property, AtomEnum::ANY, 0, 1 << 16);
        let value = cookie.unwrap().reply().unwrap().value;
        Some(String::from_utf8(value).unwrap())
    }
}
