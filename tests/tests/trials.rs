//! Tests whose cases are generated, of one kernel, node or effect each. They are one program, since each would compile and
//! link anew what all of them use.

mod bits;
mod c_host;
mod colour;
mod declarations;
mod edits;
mod goldens;
mod independence;
mod levels;
mod light;
mod openfx;
mod origin;
mod sliders;
mod tiles;
mod twins;

use isophote_tests::trials::Trials;
use std::process::ExitCode;

/// What adds the trials of a file.
type Add = fn(&mut Trials);

/// Files of tests, by their names.
const FILES: [(&str, Add); 14] = [
    ("bits", bits::add),
    ("c_host", c_host::add),
    ("colour", colour::add),
    ("declarations", declarations::add),
    ("edits", edits::add),
    ("goldens", goldens::add),
    ("independence", independence::add),
    ("levels", levels::add),
    ("light", light::add),
    ("openfx", openfx::add),
    ("origin", origin::add),
    ("sliders", sliders::add),
    ("tiles", tiles::add),
    ("twins", twins::add),
];

fn main() -> ExitCode {
    let mut trials = Trials::new();
    for (name, add) in FILES {
        trials.begin_file(name);
        add(&mut trials);
    }
    trials.run()
}
