//! Looks from files of the user's, in the effect that shows looks.

use super::looks::{CONTEXTS, LOOK_EFFECT, OfFile, in_host, wanted};
use super::reference::*;
use super::render::SIZE;
use isophote::Graph;
use isophote_abi::openfx::*;
use isophote_tests::ofx::effect::Wanted;
use isophote_tests::ofx::host::Host;
use isophote_tests::ofx::picture::{Layout, Picture};
use isophote_tests::ofx::plugin::Binary;
use isophote_tests::ofx::properties::Value;
use isophote_tests::ofx::state::Behaviour;

pub fn files_are_shown_and_faults_of_theirs_told(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[1]);
    let of_file = OfFile { instance: &instance, host: &host };
    let folder = tempfile::TempDir::new().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("it can be written");
        path
    };
    instance.edit("look", 0);
    assert!(instance.is_enabled("file") && instance.is_enabled("reload"));
    of_file.shows(None, "Choose a preset or a graph");
    let mut graph = Graph::single("cartoon").expect("a style");
    let node = graph.node(0).expect("a node");
    graph.set_text(node, "posterize", "5").expect("it has that");
    // A preset, a graph, and a preset that names the graph beside it.
    let preset = file("dusk.json", r#"{"style": "cartoon", "parameters": {"posterize": 5}}"#);
    of_file.choose(&preset);
    of_file.shows(Some(&graph), "");
    of_file.choose(&file("graph.json", &graph.to_json().expect("text")));
    of_file.shows(Some(&graph), "");
    of_file.choose(&file("names.json", r#"{"style": "graph.json", "parameters": {"posterize": 6}}"#));
    let mut six = graph.clone();
    six.set_text(node, "posterize", "6").expect("it has that");
    of_file.shows(Some(&six), "");
    // Faults, each in the place of the one before.
    let newer = graph.to_json().expect("text").replace("\"version\": 1", "\"version\": 2");
    assert!(newer.contains("\"version\": 2"));
    for (name, text, words) in [
        ("newer.json", newer.as_str(), "update Isophote"),
        ("broken.json", "{\"style\": ", "is no JSON"),
        (
            "unknown.json",
            r#"{"style": "cartoon", "parameters": {"posterise": 5}}"#,
            "did you mean 'posterize'?",
        ),
        ("alone.json", r#"{"style": "no/graph.json"}"#, "graph.json is missing"),
        ("tensor.json", r#"{"style": "structure_tensor"}"#, "makes no picture"),
    ] {
        of_file.choose(&file(name, text));
        of_file.shows(None, words);
    }
    of_file.choose(&folder.path().join("at 100 %s.json"));
    of_file.shows(None, "at 100 %s.json is missing");
    of_file.choose(&preset);
    of_file.shows(Some(&graph), "");
    // Keyframes of a preset are followed.
    of_file
        .choose(&file("keys.json", r#"{"style": "cartoon", "parameters": {"posterize": {"1": 5, "3": 7}}}"#));
    of_file.shows(Some(&graph), "");
    let layout = Layout::default();
    let wanted_at = Wanted { time: 2.0, ..Wanted::new([0, 0, WIDTH, HEIGHT]) };
    let (status, picture) = instance.try_render(layout, SIZE, &wanted_at);
    assert!(status == kOfxStatOK && picture.packed() == wanted(&six, layout));
    let answer = instance.args();
    instance.act(kOfxImageEffectActionGetClipPreferences, None, Some(&answer));
    assert_eq!(answer.int(kOfxImageEffectFrameVarying), Some(1), "frames of a still differ");
    host.no_faults();
}

pub fn files_are_read_again_when_they_change_or_the_user_asks(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[0]);
    let of_file = OfFile { instance: &instance, host: &host };
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("dusk.json");
    let graph = |posterize: u32| {
        let mut graph = Graph::single("cartoon").expect("a style");
        let node = graph.node(0).expect("a node");
        graph.set_text(node, "posterize", &posterize.to_string()).expect("it has that");
        graph
    };
    let then = std::time::SystemTime::UNIX_EPOCH + std::time::Duration::from_secs(1_700_000_000);
    let write = |posterize: u32, time| {
        let text = format!(r#"{{"style": "cartoon", "parameters": {{"posterize": {posterize}}}}}"#);
        std::fs::write(&path, text).expect("it can be written");
        let file = std::fs::File::options().write(true).open(&path).expect("it can be opened");
        file.set_modified(time).expect("its time can be set");
    };
    write(4, then);
    instance.edit("look", 0);
    of_file.choose(&path);
    of_file.shows(Some(&graph(4)), "");
    // The same size and time: kept, until the user asks.
    write(6, then);
    of_file.shows(Some(&graph(4)), "");
    instance.touch("reload");
    assert_eq!(instance.get("times_read"), [Value::Int(1)], "the host renders anew");
    of_file.shows(Some(&graph(6)), "");
    // Another time: a change.
    write(8, then + std::time::Duration::from_secs(1));
    of_file.shows(Some(&graph(8)), "");
    std::fs::remove_file(&path).expect("it can be removed");
    of_file.shows(None, "is missing");
    instance.touch("reload");
    of_file.shows(None, "is missing");
    write(4, then);
    instance.touch("reload");
    of_file.shows(Some(&graph(4)), "");
    host.no_faults();
}

/// Rules of a preset for things count where their numbers are connected; those for names that nobody knows cannot, and are told of.
pub fn rules_for_things_follow_their_numbers(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[1]);
    let of_file = OfFile { instance: &instance, host: &host };
    let folder = tempfile::TempDir::new().expect("a folder");
    let file = |name: &str, rules: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, format!(r#"{{"style": "cartoon", "objects": [{rules}]}}"#)).expect("a file");
        path
    };
    let rule =
        r##"{"match": "id:3", "lines": false, "detail": 4}, {"match": "id:200", "line_color": "#d01020"}"##;
    let (ruled, named) =
        (file("ruled.json", rule), file("named.json", r#"{"match": "cryptomatte:hero*", "lines": false}"#));
    let (color, layout) = (source(Layout::default(), false).packed(), Layout::default());
    let graph = |json: &str| isophote::preset::open_json("p.json", json, None).expect("it opens").0;
    let plain_graph = graph(r#"{"style": "cartoon"}"#);
    instance.edit("look", 0);
    of_file.choose(&ruled);
    let told = || host.inner.messages.lock().expect("messages").join("\n");
    assert!(told().contains("Connect the clip Object id"), "{}", told());
    assert!(instance.render(layout, SIZE).packed() == wanted(&plain_graph, layout));
    let numbers = Layout { components: kOfxImageComponentAlpha, depth: kOfxBitDepthByte, ..layout };
    let objects: Vec<u8> = (0..WIDTH * HEIGHT).map(|i| if i % WIDTH < WIDTH / 2 { 3 } else { 200 }).collect();
    instance.connect("ObjectId", Picture::packed_in(numbers, WIDTH, HEIGHT, &objects));
    of_file.choose(&ruled);
    assert_eq!(told(), "");
    let got = instance.render(layout, SIZE).packed();
    let floats: Vec<u8> = objects.iter().flat_map(|n| f32::from(*n).to_ne_bytes()).collect();
    let map = maps(&objects);
    let paint: Vec<u8> = map.1.iter().flat_map(|v| v.to_ne_bytes()).collect();
    let control: Vec<u8> = map.0.iter().flat_map(|v| v.to_ne_bytes()).collect();
    let ids = Layout { components: kOfxImageComponentAlpha, ..layout };
    let inputs = [
        ("color", color.as_slice(), layout),
        ("object_id", floats.as_slice(), ids),
        ("control", control.as_slice(), layout),
        ("line_paint", paint.as_slice(), layout),
    ];
    assert!(got == Through::of(&plain_graph, SIZE).c(&inputs, layout));
    assert!(got != Through::of(&plain_graph, SIZE).c(&inputs[..2], layout));
    of_file.choose(&named);
    assert!(told().contains("left out. cryptomatte:hero*") && told().contains("whole names"), "{}", told());
    host.no_faults();
}

/// Names of a Cryptomatte tell things, too, and things may have looks of their own.
pub fn rules_for_things_follow_their_names(binary: &Binary) {
    let host = Host::new(Behaviour::default());
    let instance = in_host(&host, binary, LOOK_EFFECT, CONTEXTS[1]);
    let of_file = OfFile { instance: &instance, host: &host };
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("named.json");
    let json = r#"{"style": "cartoon", "objects": [{"match": "cryptomatte:hero", "lines": false},
        {"match": "material:skin", "look": "look:wet_in_wet"}]}"#;
    std::fs::write(&path, json).expect("a file");
    let (color, layout) = (source(Layout::default(), false).packed(), Layout::default());
    instance.edit("look", 0);
    of_file.choose(&path);
    let told = || host.inner.messages.lock().expect("messages").join("\n");
    assert!(told().contains("to the clip Cryptomatte"), "{}", told());
    // The hero on the left, and skin over a part of it and of nothing.
    let [hero, skin] = ["hero", "skin"].map(|name| f32::from_bits(isophote_cryptomatte::id(name)));
    let pixel = |x: i32| match 4 * x / WIDTH {
        0 => [hero, 1.0, 0.0, 0.0],
        1 => [hero, 0.75, skin, 0.25],
        2 => [skin, 1.0, 0.0, 0.0],
        _ => [0.0; 4],
    };
    let names: Vec<u8> =
        (0..WIDTH * HEIGHT).flat_map(|at| pixel(at % WIDTH)).flat_map(f32::to_ne_bytes).collect();
    instance.connect("Cryptomatte", Picture::packed_in(layout, WIDTH, HEIGHT, &names));
    of_file.choose(&path);
    assert_eq!(told(), "");
    let share = |name: f32, [a, of_a, b, of_b]: [f32; 4]| match name {
        name if name == a => of_a,
        name if name == b => of_b,
        _ => 0.0,
    };
    let shares = |name| (0..WIDTH * HEIGHT).map(move |at| share(name, pixel(at % WIDTH)));
    let map = shares(hero).flat_map(|hero| [0.5, 0.5, 0.5 - 0.5 * hero, 0.5]);
    let control: Vec<u8> = map.flat_map(f32::to_ne_bytes).collect();
    let inputs = [("color", color.as_slice(), layout), ("control", control.as_slice(), layout)];
    let shown = |graph: &Graph| floats(&Through::of(graph, SIZE).c(&inputs, layout));
    let plain = Graph::single("cartoon").expect("a cartoon");
    let wet = isophote::preset::open("look:wet_in_wet").expect("it ships").0;
    let (under, over) = (shown(&plain), shown(&wet));
    let got = floats(&instance.render(layout, SIZE).packed());
    let shares = shares(skin).flat_map(|share| [share; 4]);
    let wanted = under.iter().zip(&over).zip(shares).map(|((a, b), share)| a + (b - a) * share);
    let most = got.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(most < 1e-5 && got != under, "{most}");
    // Ids are all bits of a float: 16 of them are no Cryptomatte.
    let short = Layout { depth: kOfxBitDepthHalf, ..layout };
    instance.connect("Cryptomatte", Picture::packed_in(short, WIDTH, HEIGHT, &vec![0; names.len() / 2]));
    of_file.choose(&path);
    assert!(told().contains("no 32-bit floats"), "{}", told());
    assert!(instance.render(layout, SIZE).packed() == Through::of(&plain, SIZE).c(&inputs[..1], layout));
    host.no_faults();
}

/// Packed pixels of floats.
fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks::<4>().0.iter().map(|value| f32::from_ne_bytes(*value)).collect()
}

/// The control map and the colours of lines that the rules of the test say.
fn maps(objects: &[u8]) -> (Vec<f32>, Vec<f32>) {
    let control = objects.iter().flat_map(|n| if *n == 3 { [1.0, 0.5, 0.0, 0.5] } else { [0.5; 4] });
    let red = isophote::value::color_from_text("#d01020").expect("a colour");
    let paint = objects.iter().flat_map(|n| if *n == 200 { red } else { [0.0; 4] });
    (control.collect(), paint.collect())
}
