//! Numbers that cross the boundary: the ABI's version, statuses, kinds, formats.

/// The version of this header. Ask `isophote_api` for it. A version is never changed once released:
/// what is new comes with a new number, and a library may offer several.
pub const ISOPHOTE_ABI_VERSION: u32 = 1;

/// Status of a call: `ISOPHOTE_OK`, which is 0, or what went wrong. The message of the last failure is asked of the object that
/// the call was made on (`graph_error`, `plan_error`, `device_error`); calls that make an object
/// hand it out in their `error` argument.
pub type IsophoteStatus = u32;

/// Success.
pub const ISOPHOTE_OK: u32 = 0;
/// A null pointer, text that is not UTF-8, or a number that is none of the listed ones.
pub const ISOPHOTE_ERROR_INVALID_ARGUMENT: u32 = 1;
/// A handle that was never given out, is of another kind, or whose object was destroyed.
pub const ISOPHOTE_ERROR_INVALID_HANDLE: u32 = 2;
/// A node, parameter, port, option, input or index that does not exist.
pub const ISOPHOTE_ERROR_UNKNOWN: u32 = 3;
/// The parameter is of another kind than the function called.
pub const ISOPHOTE_ERROR_WRONG_TYPE: u32 = 4;
/// A value that the parameter cannot have: out of range, not finite, or text that does not read as one.
pub const ISOPHOTE_ERROR_OUT_OF_RANGE: u32 = 5;
/// Ports that do not fit, a cycle, a required input left open, or no output.
pub const ISOPHOTE_ERROR_CONNECTION: u32 = 6;
/// A graph file that cannot be read as one.
pub const ISOPHOTE_ERROR_MALFORMED: u32 = 7;
/// A size, stride or region that no image can have, or an image that does not cover what is needed.
pub const ISOPHOTE_ERROR_GEOMETRY: u32 = 8;
/// An input image is missing, or has a form that its port does not take.
pub const ISOPHOTE_ERROR_INPUT: u32 = 9;
/// Something that this library does not do.
pub const ISOPHOTE_ERROR_UNSUPPORTED: u32 = 10;
/// The host asked to stop; the target image is as it was.
pub const ISOPHOTE_ERROR_CANCELLED: u32 = 11;
/// There is no graphics adapter that can do the work.
pub const ISOPHOTE_ERROR_NO_DEVICE: u32 = 12;
/// The graphics device reported an error or was lost; destroy it and create another.
pub const ISOPHOTE_ERROR_DEVICE: u32 = 13;
/// The system does not give the memory or the threads needed.
pub const ISOPHOTE_ERROR_OUT_OF_MEMORY: u32 = 14;
/// The text did not fit into the buffer; it was cut, and `length` says how long it is.
pub const ISOPHOTE_ERROR_TRUNCATED: u32 = 15;
/// A mistake inside the library, which caught it; the object may be used further.
pub const ISOPHOTE_ERROR_INTERNAL: u32 = 16;

/// Kind of image that flows through a port. One of `ISOPHOTE_KIND_...`.
pub type IsophoteKind = u32;
/// RGBA.
pub const ISOPHOTE_KIND_COLOR: u32 = 0;
/// One channel.
pub const ISOPHOTE_KIND_SCALAR: u32 = 1;
/// A symmetric 2x2 tensor (E, F, G) and its validity.
pub const ISOPHOTE_KIND_TENSOR: u32 = 2;
/// View-space normal x, y, z in -1 to 1 and its validity.
pub const ISOPHOTE_KIND_NORMAL: u32 = 3;
/// Distance from the camera, one channel, scene units; 0 or less where there is nothing.
pub const ISOPHOTE_KIND_DEPTH: u32 = 4;
/// A number per object, one channel; 0 where there is nothing.
pub const ISOPHOTE_KIND_OBJECT_ID: u32 = 5;
/// A flow map: a painted direction, x and y in red and green, 0.5 for none, and its strength in alpha. Its values are
/// data, which no colour space changes.
pub const ISOPHOTE_KIND_FLOW: u32 = 6;
/// Where a point is in another frame, from where it is in this one: 2 channels, x right and y down, in pixels of the
/// picture. What is not finite is unknown.
pub const ISOPHOTE_KIND_MOTION: u32 = 7;
/// A point x, y, z of the undeformed object in the scene's units, and 1 where there is something: 4 channels; of 3, all
/// but 0, 0, 0 is something.
pub const ISOPHOTE_KIND_POSITION: u32 = 8;
/// A control map: what an artist wants of places, 0.5 for no change; detail, width of lines, their amount, and strength of
/// the medium: 4 channels; of fewer, that strength does not change. Its values are data, which no colour space changes.
pub const ISOPHOTE_KIND_CONTROL: u32 = 9;
/// Hatching in up to four tones, the lightest first; 1 is paper and 0 is ink: 4 channels; of 3, there is no fourth tone. Its
/// values are data, which no colour space changes.
pub const ISOPHOTE_KIND_HATCHING: u32 = 10;
/// The two things that cover most of a pixel by a Cryptomatte: id of the one's name and its share of the pixel, then those of the
/// other: 4 channels of f32, as the first layer of a Cryptomatte has them. Its values are data, which nothing changes.
pub const ISOPHOTE_KIND_CRYPTOMATTE: u32 = 11;

/// Type of a parameter. One of `ISOPHOTE_PARAM_...`.
pub type IsophoteParamKind = u32;
/// A number.
pub const ISOPHOTE_PARAM_FLOAT: u32 = 0;
/// A whole number.
pub const ISOPHOTE_PARAM_INT: u32 = 1;
/// On or off.
pub const ISOPHOTE_PARAM_BOOL: u32 = 2;
/// One of several.
pub const ISOPHOTE_PARAM_CHOICE: u32 = 3;
/// RGBA, gamma-encoded sRGB, each 0 to 1.
pub const ISOPHOTE_PARAM_COLOR: u32 = 4;

/// Unit of a parameter. One of `ISOPHOTE_UNIT_...`.
pub type IsophoteUnit = u32;
/// None.
pub const ISOPHOTE_UNIT_NONE: u32 = 0;
/// Pixels of the full-size picture; scaled with the request's `scale`.
pub const ISOPHOTE_UNIT_PIXELS: u32 = 1;
/// Share of something, 0 to 100.
pub const ISOPHOTE_UNIT_PERCENT: u32 = 2;
/// Degrees of angle.
pub const ISOPHOTE_UNIT_DEGREES: u32 = 3;

/// Storage of one sample of an image, in the machine's byte order. One of `ISOPHOTE_SAMPLE_...`.
pub type IsophoteSample = u32;
/// 8-bit unsigned, 255 = 1.
pub const ISOPHOTE_SAMPLE_U8: u32 = 0;
/// 16-bit unsigned, 65535 = 1.
pub const ISOPHOTE_SAMPLE_U16: u32 = 1;
/// IEEE half.
pub const ISOPHOTE_SAMPLE_F16: u32 = 2;
/// IEEE single.
pub const ISOPHOTE_SAMPLE_F32: u32 = 3;

/// Colour space of the numbers of a picture; the result has the same. One of `ISOPHOTE_SPACE_...`.
pub type IsophoteSpace = u32;
/// Gamma-encoded sRGB.
pub const ISOPHOTE_SPACE_SRGB: u32 = 0;
/// Linear light, Rec. 709 primaries.
pub const ISOPHOTE_SPACE_LINEAR: u32 = 1;
/// ACEScg: linear light, AP1 primaries.
pub const ISOPHOTE_SPACE_ACESCG: u32 = 2;

/// Relation of colour to alpha, in the input and in the result. One of `ISOPHOTE_ALPHA_...`.
pub type IsophoteAlpha = u32;
/// Colour is multiplied by alpha.
pub const ISOPHOTE_ALPHA_PREMULTIPLIED: u32 = 0;
/// It is not.
pub const ISOPHOTE_ALPHA_STRAIGHT: u32 = 1;
/// Colour is multiplied by alpha, and may have light where alpha is 0 or little: fire, glows, additive renders. It is
/// filtered apart and added to the result, which costs as much again. `process` finds out by itself.
pub const ISOPHOTE_ALPHA_EMISSIVE: u32 = 2;

// guides: generated by `cargo xtask guides`
/// Bit of `IsophoteRequest::guides` for `normal`: view-space normals, x right, y up, z towards the camera.
pub const ISOPHOTE_GUIDE_NORMAL: u32 = 1;
/// Bit of `IsophoteRequest::guides` for `depth`: distance from the camera, 0 or less where there is nothing.
pub const ISOPHOTE_GUIDE_DEPTH: u32 = 2;
/// Bit of `IsophoteRequest::guides` for `object_id`: a number per object, 0 where there is nothing.
pub const ISOPHOTE_GUIDE_OBJECT_ID: u32 = 4;
/// Bit of `IsophoteRequest::guides` for `mask`: share of the result that is used, 0 to 1.
pub const ISOPHOTE_GUIDE_MASK: u32 = 8;
/// Bit of `IsophoteRequest::guides` for `flow`: a painted flow map: x and y in red and green, 0.5 for none, and its
/// strength in alpha.
pub const ISOPHOTE_GUIDE_FLOW: u32 = 16;
/// Bit of `IsophoteRequest::guides` for `motion`: pixels from where points are to where they were in the frame before.
pub const ISOPHOTE_GUIDE_MOTION: u32 = 32;
/// Bit of `IsophoteRequest::guides` for `motion_forward`: pixels from where points are to where they will be in the
/// next frame.
pub const ISOPHOTE_GUIDE_MOTION_FORWARD: u32 = 64;
/// Bit of `IsophoteRequest::guides` for `rest_position`: points of the undeformed objects.
pub const ISOPHOTE_GUIDE_REST_POSITION: u32 = 128;
/// Bit of `IsophoteRequest::guides` for `albedo`: colours of surfaces without light, in the picture's space.
pub const ISOPHOTE_GUIDE_ALBEDO: u32 = 256;
/// Bit of `IsophoteRequest::guides` for `diffuse`: light that surfaces reflect in all directions, in their colours and
/// the picture's space.
pub const ISOPHOTE_GUIDE_DIFFUSE: u32 = 512;
/// Bit of `IsophoteRequest::guides` for `specular`: light that surfaces mirror: highlights and reflections, in the
/// picture's space.
pub const ISOPHOTE_GUIDE_SPECULAR: u32 = 1024;
/// Bit of `IsophoteRequest::guides` for `control`: a control map, 0.5 for no change: detail, width of lines, their
/// amount, and strength of the medium.
pub const ISOPHOTE_GUIDE_CONTROL: u32 = 2048;
/// Bit of `IsophoteRequest::guides` for `paper`: a sheet of paper: its colours, and its grain, which is deep where it
/// is darker than around; white where it is transparent.
pub const ISOPHOTE_GUIDE_PAPER: u32 = 4096;
/// Bit of `IsophoteRequest::guides` for `hatching`: hatching in up to four tones, the lightest in red and the darkest
/// in alpha: 1 is paper, 0 is ink.
pub const ISOPHOTE_GUIDE_HATCHING: u32 = 8192;
/// Bit of `IsophoteRequest::guides` for `line_paint`: colours of lines: that of the line here, as far as it is opaque.
pub const ISOPHOTE_GUIDE_LINE_PAINT: u32 = 16384;
/// Bit of `IsophoteRequest::guides` for `cryptomatte`: the two things that cover most of a pixel by a Cryptomatte: id
/// of the one's name and its share, then those of the other.
pub const ISOPHOTE_GUIDE_CRYPTOMATTE: u32 = 32768;
// end of guides

/// Purpose of a texture of a plan. One of `ISOPHOTE_ROLE_...`.
pub type IsophoteRole = u32;
/// The host binds its own texture, which shows the window of the picture that the plan names.
pub const ISOPHOTE_ROLE_INPUT: u32 = 0;
/// A result.
pub const ISOPHOTE_ROLE_OUTPUT: u32 = 1;
/// Scratch memory; its contents need not survive from one run to the next.
pub const ISOPHOTE_ROLE_TRANSIENT: u32 = 2;

/// Texel format of a texture of a plan. One of `ISOPHOTE_FORMAT_...`.
pub type IsophoteFormat = u32;
/// One 32-bit float: `r32float`, `DXGI_FORMAT_R32_FLOAT`, `VK_FORMAT_R32_SFLOAT`.
pub const ISOPHOTE_FORMAT_R32F: u32 = 0;
/// Two 32-bit floats: `rg32float`.
pub const ISOPHOTE_FORMAT_RG32F: u32 = 1;
/// Four 32-bit floats: `rgba32float`.
pub const ISOPHOTE_FORMAT_RGBA32F: u32 = 2;
/// Four 16-bit floats: `rgba16float`, `DXGI_FORMAT_R16G16B16A16_FLOAT`, `VK_FORMAT_R16G16B16A16_SFLOAT`. Only in plans of
/// graphs whose precision says so.
pub const ISOPHOTE_FORMAT_RGBA16F: u32 = 3;

/// Result of an update of a plan. One of `ISOPHOTE_CHANGE_...`.
pub type IsophoteChange = u32;
/// Uniform bytes were rewritten in place; every pointer handed out before stays valid.
pub const ISOPHOTE_CHANGE_UNIFORMS: u32 = 0;
/// Textures and passes are others now; every pointer handed out before is void.
pub const ISOPHOTE_CHANGE_STRUCTURE: u32 = 1;

/// Language of a shader. One of `ISOPHOTE_LANGUAGE_...`.
pub type IsophoteLanguage = u32;
/// WGSL, as the kernel was written. Kernels that read windows of neighbours through workgroup memory declare
/// `override shared_windows: bool = true`; without it they fetch each tap, which suits drivers that compute on
/// the CPU. Other languages come with the default.
pub const ISOPHOTE_LANGUAGE_WGSL: u32 = 0;
/// SPIR-V 1.0 for Vulkan 1.0, in words of 32 bits.
pub const ISOPHOTE_LANGUAGE_SPIRV: u32 = 1;
/// HLSL, shader model 5.0 (Direct3D 11 and 12).
pub const ISOPHOTE_LANGUAGE_HLSL: u32 = 2;
/// Metal Shading Language 2.0.
pub const ISOPHOTE_LANGUAGE_MSL: u32 = 3;
/// GLSL 4.30 core.
pub const ISOPHOTE_LANGUAGE_GLSL: u32 = 4;

/// Kind of resource at a binding of a shader. One of `ISOPHOTE_BINDING_...`.
pub type IsophoteBindingKind = u32;
/// A uniform buffer.
pub const ISOPHOTE_BINDING_UNIFORM: u32 = 0;
/// A texture that is read by integer loads, never filtered, without a sampler.
pub const ISOPHOTE_BINDING_SAMPLED: u32 = 1;
/// A texture that is written.
pub const ISOPHOTE_BINDING_STORAGE: u32 = 2;
/// A sampler: linear in both directions, clamped to the edge, without mip levels. Only in plans of graphs whose precision
/// is `ISOPHOTE_PRECISION_FAST`.
pub const ISOPHOTE_BINDING_SAMPLER: u32 = 3;
