//! Panels for Shotcut: what the filter is, and the form with its controls.

use super::panel::{Control, Kind, Panel, decimals, shown};
use std::fmt::Write as _;

/// Rows are so high, in the form's pixels.
const ROW: usize = 34;

/// Description of the filter.
pub fn meta(panel: &Panel) -> String {
    format!(
        "import QtQuick\nimport org.shotcut.qml\n\nMetadata {{\n    type: Metadata.Filter\n    objectName: {}\n    \
         name: {}\n    mlt_service: {}\n    keywords: {}\n    qml: 'ui.qml'\n    icon: 'icon.png'\n}}\n",
        quoted(&format!("isophote_{}", panel.id)),
        quoted(&format!("Isophote: {}", panel.label)),
        quoted(&panel.service()),
        quoted(&format!(
            "isophote stylize {} {} #openfx",
            panel.id.replace('_', " "),
            panel.label.to_lowercase()
        ))
    )
}

/// The form.
pub fn ui(panel: &Panel) -> String {
    let names: Vec<String> = panel.controls.iter().map(|control| quoted(&control.name)).collect();
    let mut text = format!(
        "import QtQuick\nimport QtQuick.Controls\nimport QtQuick.Layouts\nimport Shotcut.Controls as Shotcut\n\n\
         Item {{\n    property bool blockUpdate: true\n    property var names: [{}]\n\n    width: 350\n    \
         height: {}\n\n    function setControls() {{\n        blockUpdate = true;\n",
        names.join(", "),
        (panel.controls.len() + headings(panel)) * ROW + ROW
    );
    for control in &panel.controls {
        let _ = writeln!(text, "        {}", taken(control));
    }
    text.push_str(
        "        blockUpdate = false;\n    }\n\n    Component.onCompleted: {\n        if (filter.isNew) {\n",
    );
    for control in &panel.controls {
        let _ = writeln!(text, "            filter.set({}, {});", quoted(&control.name), default(control));
    }
    text.push_str(
        "            filter.savePreset(names);\n        }\n        setControls();\n    }\n\n    GridLayout {\n        \
         anchors.fill: parent\n        anchors.margins: 8\n        columns: 3\n\n        Label {\n            \
         text: qsTr('Preset')\n            Layout.alignment: Qt.AlignRight\n        }\n        Shotcut.Preset {\n            \
         parameters: names\n            Layout.columnSpan: 2\n            onPresetSelected: setControls()\n        }\n",
    );
    let mut group = "";
    for control in &panel.controls {
        if control.group != group {
            group = &control.group;
            heading(&mut text, group);
        }
        row(&mut text, control);
    }
    text.push_str("        Item {\n            Layout.fillHeight: true\n        }\n    }\n}\n");
    text
}

fn headings(panel: &Panel) -> usize {
    let mut count = 0;
    let mut group = "";
    for control in &panel.controls {
        if control.group != group {
            group = &control.group;
            count += 1;
        }
    }
    count
}

/// Code by which the form takes a value over from the filter.
fn taken(control: &Control) -> String {
    let (id, name) = (id(control), quoted(&control.name));
    match control.kind {
        Kind::Number { .. } => format!("{id}.value = filter.getDouble({name});"),
        Kind::Switch { .. } => format!("{id}.checked = filter.get({name}) === '1';"),
        Kind::Choice { .. } => {
            format!("{id}.currentIndex = Math.max(0, {id}.find(filter.get({name})));")
        }
        Kind::Color { .. } => format!("{id}.value = filter.getColor({name});"),
    }
}

fn default(control: &Control) -> String {
    match &control.kind {
        Kind::Number { default, .. } => shown(*default),
        Kind::Switch { default } => u8::from(*default).to_string(),
        Kind::Choice { default, .. } => quoted(default),
        Kind::Color { default } => quoted(default),
    }
}

fn heading(text: &mut String, group: &str) {
    let mut letters = group.chars();
    let shown =
        letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect());
    let _ = write!(
        text,
        "\n        Label {{\n            text: {}\n            font.bold: true\n            Layout.columnSpan: 3\n        \
         }}\n",
        translated(&shown)
    );
}

/// A label with its sentence where the pointer rests, the control, and the way back to the default.
fn row(text: &mut String, control: &Control) {
    let _ = write!(
        text,
        "\n        Label {{\n            text: {}\n            Layout.alignment: Qt.AlignRight\n\n            \
         Shotcut.HoverTip {{\n                text: {}\n            }}\n        }}\n",
        translated(&control.label),
        translated(&control.doc)
    );
    let (what, reset) = form(control);
    let _ = write!(
        text,
        "        {what}\n        }}\n        Shotcut.UndoButton {{\n            onClicked: {reset}\n        }}\n"
    );
}

/// A control without its closing brace, and the statement that brings its default back.
fn form(control: &Control) -> (String, String) {
    let (id, name) = (id(control), quoted(&control.name));
    let set = |value: &str| {
        format!(
            "{{\n                if (!blockUpdate)\n                    filter.set({name}, {value});\n            }}"
        )
    };
    match &control.kind {
        Kind::Number { default, slider, is_whole } => {
            let decimals = decimals(*slider, *default, *is_whole);
            let form = format!(
                "Shotcut.SliderSpinner {{\n            id: {id}\n            minimumValue: {}\n            \
                 maximumValue: {}\n            decimals: {decimals}\n            stepSize: {}\n            \
                 onValueChanged: {}",
                shown(slider[0]),
                shown(slider[1]),
                if *is_whole {
                    "1".to_owned()
                } else {
                    format!("{:.decimals$}", 0.1_f64.powi(decimals as i32))
                },
                set("value")
            );
            (form, format!("{id}.value = {}", shown(*default)))
        }
        Kind::Switch { default } => (
            format!(
                "CheckBox {{\n            id: {id}\n            onCheckedChanged: {}",
                set("checked ? 1 : 0")
            ),
            format!("{id}.checked = {default}"),
        ),
        Kind::Choice { default, options } => {
            let model: Vec<String> = options.iter().map(|option| quoted(option)).collect();
            let form = format!(
                "Shotcut.ComboBox {{\n            id: {id}\n            implicitWidth: 200\n            model: [{}]\n            \
                 onCurrentIndexChanged: {}",
                model.join(", "),
                set("textAt(currentIndex)")
            );
            (form, format!("{id}.currentIndex = {id}.find({})", quoted(default)))
        }
        Kind::Color { default } => (
            format!(
                "Shotcut.ColorPicker {{\n            id: {id}\n            alpha: true\n            onValueChanged: {}",
                set("String(value)")
            ),
            format!("{id}.value = {}", quoted(default)),
        ),
    }
}

/// The name of a control in the form; names of the plugin begin with a small letter.
fn id(control: &Control) -> String {
    format!("{}_control", control.name)
}

fn translated(text: &str) -> String {
    format!("qsTr({})", quoted(text))
}

/// A text in the quotes of JavaScript.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\\', "\\\\").replace('\'', "\\'").replace('\n', " "))
}
