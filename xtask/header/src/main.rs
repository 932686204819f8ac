//! `isophote-header [--check]`, run by `cargo xtask header`: writes `include/isophote.h` from the Rust
//! declarations.
//!
//! The header is committed, so that nobody needs this tool to use the library; `--check` compares
//! instead of writing, and fails when the two have drifted apart.

use cbindgen::{Builder, Config, DocumentationStyle, Language};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The files that declare the contract, in the order of the header.
const SOURCES: [&str; 11] = [
    "include/src/constants.rs",
    "include/src/types.rs",
    "include/src/table.rs",
    "include/src/sequences.rs",
    "include/src/precision.rs",
    "include/src/memory.rs",
    "include/src/guides.rs",
    "include/src/pixel_aspect.rs",
    "include/src/presets.rs",
    "include/src/vulkan.rs",
    "nodes/plugin/src/abi/entry.rs",
];

const PREAMBLE: &str = "\
/* Isophote: structure-adaptive stylization filters.
 *
 * The library exports one symbol, isophote_api. Look it up with dlsym or GetProcAddress, or link against it; ask it for
 * ISOPHOTE_ABI_VERSION, and call everything else through the table that it returns.
 *
 * Objects
 *
 *   IsophoteGraph   nodes, their parameters and connections
 *   IsophotePlan    what a graph comes to for one size: textures and passes, for a graphics device of the host's own
 *   IsophoteDevice  a graphics device of the library's own; {0} is the CPU
 *
 * Extensions have objects of their own.
 *
 * Order of calls
 *
 *   api = isophote_api(ISOPHOTE_ABI_VERSION);
 *   api->graph_create_single(\"cartoon\", &error, &graph);
 *   api->graph_set_float(graph, 0, \"detail\", 0.4);             as often as wanted
 *   api->request_init(width, height, &request);
 *   api->process(graph, cpu, &request, inputs, 1, NULL, &target, NULL, NULL);   for images in memory
 *   api->graph_destroy(graph);
 *
 * Frames of a sequence that are steady over time, in any order, need the extension
 *
 *   const struct IsophoteSequenceApi *sequences = api->extension(\"isophote.sequence/1\");
 *
 * Half the bytes on graphics devices, where eleven bits of colour suffice, are asked for by
 *
 *   const struct IsophotePrecisionApi *precision = api->extension(\"isophote.precision/1\");
 *
 * Pictures of any size within bounded memory, on the CPU:
 *
 *   const struct IsophoteMemoryApi *memory = api->extension(\"isophote.memory/1\");
 *
 * The pictures that may enter a graph beside the colour, and presets, looks and colours as people write them, are those of
 *
 *   const struct IsophoteGuidesApi *guides = api->extension(\"isophote.guides/1\");
 *   const struct IsophotePresetsApi *presets = api->extension(\"isophote.presets/1\");
 *
 * Pixels that are not square, as those of anamorphic pictures, are made so and back by
 *
 *   const struct IsophotePixelAspectApi *aspects = api->extension(\"isophote.pixel_aspect/1\");
 *
 * A host that renders with Vulkan records the filter into its command buffers, from and to its images:
 *
 *   const struct IsophoteVulkanApi *vulkans = api->extension(\"isophote.vulkan/1\");
 *   vulkans->needs(VK_API_VERSION_1_2, &error, &needs);          features to create the device with
 *   vulkans->create(&host, &error, &vulkan);
 *   vulkans->effect_create(vulkan, graph, &request, &error, &effect);
 *   each frame:
 *       vulkans->effect_update(effect, graph, &request, &change);
 *       vulkans->record(effect, command_buffer, images, image_count, value);
 *   vulkans->effect_destroy(effect), vulkans->destroy(vulkan);
 *
 * A host that renders with anything else runs the plan:
 *
 *   api->plan_create(graph, &request, NULL, &error, &plan);
 *   api->plan_textures(plan, &textures, &texture_count);         make those that are transient or an output
 *   api->plan_passes(plan, &passes, &pass_count);
 *   for (i = 0; i < pass_count; i++)
 *       api->plan_shader(plan, i, ISOPHOTE_LANGUAGE_SPIRV, &shader);   make a pipeline of each kernel
 *   each frame:
 *       api->graph_set_float(...), api->plan_update(plan, graph, &request, &change);
 *       for (i = 0; i < pass_count; i++)
 *           bind passes[i].grid and passes[i].params as uniforms, the textures passes[i].inputs and passes[i].outputs,
 *           dispatch passes[i].workgroups, and let the next pass wait for what it reads
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */";

/// Calling convention and import, and what begins C linkage.
const OPENING: &str = "
/* The calling convention of every function here. */
#ifndef ISOPHOTE_ABI
#ifdef _WIN32
#define ISOPHOTE_ABI __cdecl
#else
#define ISOPHOTE_ABI
#endif
#endif

/* How isophote_api is declared to hosts that link against the library. Define it as nothing before this header for
 * a static library. */
#ifndef ISOPHOTE_IMPORT
#ifdef _WIN32
#define ISOPHOTE_IMPORT __declspec(dllimport)
#else
#define ISOPHOTE_IMPORT
#endif
#endif

#ifdef __cplusplus
extern \"C\" {
#endif
";

const CLOSING: &str = "\
#ifdef __cplusplus
} /* extern \"C\" */
#endif";

/// The one function that is declared and not in the table.
const ENTRY: &str = "const struct IsophoteApi *isophote_api(uint32_t abi_version);";

const WARNING: &str = "/* Generated from include/src by `cargo xtask header`. Do not edit. */";

/// Reason why the header was not written, or is not true.
#[derive(Debug, thiserror::Error)]
enum Error {
    #[error("cannot read the declarations: {0}")]
    Declarations(#[from] cbindgen::Error),
    #[error("the header is not text: {0}")]
    Text(#[from] std::string::FromUtf8Error),
    #[error("cannot read or write {}: {source}", path.display())]
    File { path: PathBuf, source: std::io::Error },
    #[error("the entry point is not declared as expected")]
    Entry,
    #[error(
        "include/isophote.h is not what include/src declares, from line {0} on: run `cargo xtask header`"
    )]
    Stale(usize),
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let check = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => false,
        ["--check"] => true,
        _ => {
            eprintln!("usage: isophote-header [--check]");
            return ExitCode::from(2);
        }
    };
    match run(check) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("isophote-header: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the header or, with `check`, compares it.
fn run(check: bool) -> Result<(), Error> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let target = root.join("include/isophote.h");
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::File { path, source }
    };
    let text = generate(&root)?;
    if !check {
        let beside = target.with_extension("h.new");
        fs::write(&beside, text).map_err(at(&beside))?;
        return fs::rename(&beside, &target).map_err(at(&target));
    }
    let found = fs::read_to_string(&target).map_err(at(&target))?;
    if found == text {
        return Ok(());
    }
    Err(Error::Stale(found.lines().zip(text.lines()).take_while(|(a, b)| a == b).count() + 1))
}

fn generate(root: &Path) -> Result<String, Error> {
    let mut config = Config {
        language: Language::C,
        after_includes: Some(OPENING.into()),
        header: Some(PREAMBLE.into()),
        autogen_warning: Some(WARNING.into()),
        include_guard: Some("ISOPHOTE_H".into()),
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        usize_is_size_t: true,
        line_length: 100,
        documentation_style: DocumentationStyle::C99,
        ..Config::default()
    };
    // Only the documents name the type of the entry point, and tables of extensions, which are asked for by a string.
    config.export.include = [
        "IsophoteEntry",
        "IsophoteSequenceApi",
        "IsophotePrecisionApi",
        "IsophoteMemoryApi",
        "IsophoteGuidesApi",
        "IsophotePixelAspectApi",
        "IsophotePresetsApi",
        "IsophoteVulkanApi",
    ]
    .map(Into::into)
    .into();
    let mut builder = Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(root.join(source));
    }
    let bindings = builder.generate()?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    // cbindgen knows no calling conventions.
    let text = String::from_utf8(text)?.replace("(*", "(ISOPHOTE_ABI *");
    let imported =
        "ISOPHOTE_IMPORT const struct IsophoteApi *ISOPHOTE_ABI isophote_api(uint32_t abi_version);";
    if !text.contains(ENTRY) {
        return Err(Error::Entry);
    }
    let text = text.replace(ENTRY, imported).replace("\n\n\n", "\n\n");
    // Before the end of the guard, or a second inclusion would close what it did not open.
    Ok(text.replace("#endif  /* ISOPHOTE_H */", &format!("{CLOSING}\n\n#endif  /* ISOPHOTE_H */")))
}
