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
 *   api->graph_create_single("cartoon", &error, &graph);
 *   api->graph_set_float(graph, 0, "detail", 0.4);             as often as wanted
 *   api->request_init(width, height, &request);
 *   api->process(graph, cpu, &request, inputs, 1, NULL, &target, NULL, NULL);   for images in memory
 *   api->graph_destroy(graph);
 *
 * Frames of a sequence that are steady over time, in any order, need the extension
 *
 *   const struct IsophoteSequenceApi *sequences = api->extension("isophote.sequence/1");
 *
 * Half the bytes on graphics devices, where eleven bits of colour suffice, are asked for by
 *
 *   const struct IsophotePrecisionApi *precision = api->extension("isophote.precision/1");
 *
 * Pictures of any size within bounded memory, on the CPU:
 *
 *   const struct IsophoteMemoryApi *memory = api->extension("isophote.memory/1");
 *
 * The pictures that may enter a graph beside the colour, and presets, looks and colours as people write them, are those of
 *
 *   const struct IsophoteGuidesApi *guides = api->extension("isophote.guides/1");
 *   const struct IsophotePresetsApi *presets = api->extension("isophote.presets/1");
 *
 * Pixels that are not square, as those of anamorphic pictures, are made so and back by
 *
 *   const struct IsophotePixelAspectApi *aspects = api->extension("isophote.pixel_aspect/1");
 *
 * A host that renders with Vulkan records the filter into its command buffers, from and to its images:
 *
 *   const struct IsophoteVulkanApi *vulkans = api->extension("isophote.vulkan/1");
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
 */

#ifndef ISOPHOTE_H
#define ISOPHOTE_H

/* Generated from include/src by `cargo xtask header`. Do not edit. */

#include <stddef.h>
#include <stdint.h>

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
extern "C" {
#endif

// The version of this header. Ask `isophote_api` for it. A version is never changed once released:
// what is new comes with a new number, and a library may offer several.
#define ISOPHOTE_ABI_VERSION 1

// Success.
#define ISOPHOTE_OK 0

// A null pointer, text that is not UTF-8, or a number that is none of the listed ones.
#define ISOPHOTE_ERROR_INVALID_ARGUMENT 1

// A handle that was never given out, is of another kind, or whose object was destroyed.
#define ISOPHOTE_ERROR_INVALID_HANDLE 2

// A node, parameter, port, option, input or index that does not exist.
#define ISOPHOTE_ERROR_UNKNOWN 3

// The parameter is of another kind than the function called.
#define ISOPHOTE_ERROR_WRONG_TYPE 4

// A value that the parameter cannot have: out of range, not finite, or text that does not read as one.
#define ISOPHOTE_ERROR_OUT_OF_RANGE 5

// Ports that do not fit, a cycle, a required input left open, or no output.
#define ISOPHOTE_ERROR_CONNECTION 6

// A graph file that cannot be read as one.
#define ISOPHOTE_ERROR_MALFORMED 7

// A size, stride or region that no image can have, or an image that does not cover what is needed.
#define ISOPHOTE_ERROR_GEOMETRY 8

// An input image is missing, or has a form that its port does not take.
#define ISOPHOTE_ERROR_INPUT 9

// Something that this library does not do.
#define ISOPHOTE_ERROR_UNSUPPORTED 10

// The host asked to stop; the target image is as it was.
#define ISOPHOTE_ERROR_CANCELLED 11

// There is no graphics adapter that can do the work.
#define ISOPHOTE_ERROR_NO_DEVICE 12

// The graphics device reported an error or was lost; destroy it and create another.
#define ISOPHOTE_ERROR_DEVICE 13

// The system does not give the memory or the threads needed.
#define ISOPHOTE_ERROR_OUT_OF_MEMORY 14

// The text did not fit into the buffer; it was cut, and `length` says how long it is.
#define ISOPHOTE_ERROR_TRUNCATED 15

// A mistake inside the library, which caught it; the object may be used further.
#define ISOPHOTE_ERROR_INTERNAL 16

// RGBA.
#define ISOPHOTE_KIND_COLOR 0

// One channel.
#define ISOPHOTE_KIND_SCALAR 1

// A symmetric 2x2 tensor (E, F, G) and its validity.
#define ISOPHOTE_KIND_TENSOR 2

// View-space normal x, y, z in -1 to 1 and its validity.
#define ISOPHOTE_KIND_NORMAL 3

// Distance from the camera, one channel, scene units; 0 or less where there is nothing.
#define ISOPHOTE_KIND_DEPTH 4

// A number per object, one channel; 0 where there is nothing.
#define ISOPHOTE_KIND_OBJECT_ID 5

// A flow map: a painted direction, x and y in red and green, 0.5 for none, and its strength in alpha. Its values are
// data, which no colour space changes.
#define ISOPHOTE_KIND_FLOW 6

// Where a point is in another frame, from where it is in this one: 2 channels, x right and y down, in pixels of the
// picture. What is not finite is unknown.
#define ISOPHOTE_KIND_MOTION 7

// A point x, y, z of the undeformed object in the scene's units, and 1 where there is something: 4 channels; of 3, all
// but 0, 0, 0 is something.
#define ISOPHOTE_KIND_POSITION 8

// A control map: what an artist wants of places, 0.5 for no change; detail, width of lines, their amount, and strength of
// the medium: 4 channels; of fewer, that strength does not change. Its values are data, which no colour space changes.
#define ISOPHOTE_KIND_CONTROL 9

// Hatching in up to four tones, the lightest first; 1 is paper and 0 is ink: 4 channels; of 3, there is no fourth tone. Its
// values are data, which no colour space changes.
#define ISOPHOTE_KIND_HATCHING 10

// The two things that cover most of a pixel by a Cryptomatte: id of the one's name and its share of the pixel, then those of the
// other: 4 channels of f32, as the first layer of a Cryptomatte has them. Its values are data, which nothing changes.
#define ISOPHOTE_KIND_CRYPTOMATTE 11

// A number.
#define ISOPHOTE_PARAM_FLOAT 0

// A whole number.
#define ISOPHOTE_PARAM_INT 1

// On or off.
#define ISOPHOTE_PARAM_BOOL 2

// One of several.
#define ISOPHOTE_PARAM_CHOICE 3

// RGBA, gamma-encoded sRGB, each 0 to 1.
#define ISOPHOTE_PARAM_COLOR 4

// None.
#define ISOPHOTE_UNIT_NONE 0

// Pixels of the full-size picture; scaled with the request's `scale`.
#define ISOPHOTE_UNIT_PIXELS 1

// Share of something, 0 to 100.
#define ISOPHOTE_UNIT_PERCENT 2

// Degrees of angle.
#define ISOPHOTE_UNIT_DEGREES 3

// 8-bit unsigned, 255 = 1.
#define ISOPHOTE_SAMPLE_U8 0

// 16-bit unsigned, 65535 = 1.
#define ISOPHOTE_SAMPLE_U16 1

// IEEE half.
#define ISOPHOTE_SAMPLE_F16 2

// IEEE single.
#define ISOPHOTE_SAMPLE_F32 3

// Gamma-encoded sRGB.
#define ISOPHOTE_SPACE_SRGB 0

// Linear light, Rec. 709 primaries.
#define ISOPHOTE_SPACE_LINEAR 1

// ACEScg: linear light, AP1 primaries.
#define ISOPHOTE_SPACE_ACESCG 2

// Colour is multiplied by alpha.
#define ISOPHOTE_ALPHA_PREMULTIPLIED 0

// It is not.
#define ISOPHOTE_ALPHA_STRAIGHT 1

// Colour is multiplied by alpha, and may have light where alpha is 0 or little: fire, glows, additive renders. It is
// filtered apart and added to the result, which costs as much again. `process` finds out by itself.
#define ISOPHOTE_ALPHA_EMISSIVE 2

// Bit of `IsophoteRequest::guides` for `normal`: view-space normals, x right, y up, z towards the camera.
#define ISOPHOTE_GUIDE_NORMAL 1

// Bit of `IsophoteRequest::guides` for `depth`: distance from the camera, 0 or less where there is nothing.
#define ISOPHOTE_GUIDE_DEPTH 2

// Bit of `IsophoteRequest::guides` for `object_id`: a number per object, 0 where there is nothing.
#define ISOPHOTE_GUIDE_OBJECT_ID 4

// Bit of `IsophoteRequest::guides` for `mask`: share of the result that is used, 0 to 1.
#define ISOPHOTE_GUIDE_MASK 8

// Bit of `IsophoteRequest::guides` for `flow`: a painted flow map: x and y in red and green, 0.5 for none, and its
// strength in alpha.
#define ISOPHOTE_GUIDE_FLOW 16

// Bit of `IsophoteRequest::guides` for `motion`: pixels from where points are to where they were in the frame before.
#define ISOPHOTE_GUIDE_MOTION 32

// Bit of `IsophoteRequest::guides` for `motion_forward`: pixels from where points are to where they will be in the
// next frame.
#define ISOPHOTE_GUIDE_MOTION_FORWARD 64

// Bit of `IsophoteRequest::guides` for `rest_position`: points of the undeformed objects.
#define ISOPHOTE_GUIDE_REST_POSITION 128

// Bit of `IsophoteRequest::guides` for `albedo`: colours of surfaces without light, in the picture's space.
#define ISOPHOTE_GUIDE_ALBEDO 256

// Bit of `IsophoteRequest::guides` for `diffuse`: light that surfaces reflect in all directions, in their colours and
// the picture's space.
#define ISOPHOTE_GUIDE_DIFFUSE 512

// Bit of `IsophoteRequest::guides` for `specular`: light that surfaces mirror: highlights and reflections, in the
// picture's space.
#define ISOPHOTE_GUIDE_SPECULAR 1024

// Bit of `IsophoteRequest::guides` for `control`: a control map, 0.5 for no change: detail, width of lines, their
// amount, and strength of the medium.
#define ISOPHOTE_GUIDE_CONTROL 2048

// Bit of `IsophoteRequest::guides` for `paper`: a sheet of paper: its colours, and its grain, which is deep where it
// is darker than around; white where it is transparent.
#define ISOPHOTE_GUIDE_PAPER 4096

// Bit of `IsophoteRequest::guides` for `hatching`: hatching in up to four tones, the lightest in red and the darkest
// in alpha: 1 is paper, 0 is ink.
#define ISOPHOTE_GUIDE_HATCHING 8192

// Bit of `IsophoteRequest::guides` for `line_paint`: colours of lines: that of the line here, as far as it is opaque.
#define ISOPHOTE_GUIDE_LINE_PAINT 16384

// Bit of `IsophoteRequest::guides` for `cryptomatte`: the two things that cover most of a pixel by a Cryptomatte: id
// of the one's name and its share, then those of the other.
#define ISOPHOTE_GUIDE_CRYPTOMATTE 32768

// The host binds its own texture, which shows the window of the picture that the plan names.
#define ISOPHOTE_ROLE_INPUT 0

// A result.
#define ISOPHOTE_ROLE_OUTPUT 1

// Scratch memory; its contents need not survive from one run to the next.
#define ISOPHOTE_ROLE_TRANSIENT 2

// One 32-bit float: `r32float`, `DXGI_FORMAT_R32_FLOAT`, `VK_FORMAT_R32_SFLOAT`.
#define ISOPHOTE_FORMAT_R32F 0

// Two 32-bit floats: `rg32float`.
#define ISOPHOTE_FORMAT_RG32F 1

// Four 32-bit floats: `rgba32float`.
#define ISOPHOTE_FORMAT_RGBA32F 2

// Four 16-bit floats: `rgba16float`, `DXGI_FORMAT_R16G16B16A16_FLOAT`, `VK_FORMAT_R16G16B16A16_SFLOAT`. Only in plans of
// graphs whose precision says so.
#define ISOPHOTE_FORMAT_RGBA16F 3

// Uniform bytes were rewritten in place; every pointer handed out before stays valid.
#define ISOPHOTE_CHANGE_UNIFORMS 0

// Textures and passes are others now; every pointer handed out before is void.
#define ISOPHOTE_CHANGE_STRUCTURE 1

// WGSL, as the kernel was written. Kernels that read windows of neighbours through workgroup memory declare
// `override shared_windows: bool = true`; without it they fetch each tap, which suits drivers that compute on
// the CPU. Other languages come with the default.
#define ISOPHOTE_LANGUAGE_WGSL 0

// SPIR-V 1.0 for Vulkan 1.0, in words of 32 bits.
#define ISOPHOTE_LANGUAGE_SPIRV 1

// HLSL, shader model 5.0 (Direct3D 11 and 12).
#define ISOPHOTE_LANGUAGE_HLSL 2

// Metal Shading Language 2.0.
#define ISOPHOTE_LANGUAGE_MSL 3

// GLSL 4.30 core.
#define ISOPHOTE_LANGUAGE_GLSL 4

// A uniform buffer.
#define ISOPHOTE_BINDING_UNIFORM 0

// A texture that is read by integer loads, never filtered, without a sampler.
#define ISOPHOTE_BINDING_SAMPLED 1

// A texture that is written.
#define ISOPHOTE_BINDING_STORAGE 2

// A sampler: linear in both directions, clamped to the edge, without mip levels. Only in plans of graphs whose precision
// is `ISOPHOTE_PRECISION_FAST`.
#define ISOPHOTE_BINDING_SAMPLER 3

// Every texture holds 32-bit floats, as the CPU does.
#define ISOPHOTE_PRECISION_EXACT 0

// Colours are kept in 16-bit floats, those of outputs too: half the bytes, and eleven bits for each value up to 65504.
// The rows and columns of windows of up to 17 pixels are one pass: a parameter by which one outgrows that changes the
// structure of a plan.
#define ISOPHOTE_PRECISION_HALF 1

// As half; besides, shaders interpolate colours by a sampler. Its textures are those of the plan with the format
// `ISOPHOTE_FORMAT_RGBA16F`; what a host binds in the place of such an input must have a format that its device filters.
// Shaders in WGSL and SPIR-V only.
#define ISOPHOTE_PRECISION_FAST 2

// Lines of the picture that lengths are meant for, unless a preset says that they are pixels of the picture itself. See
// `IsophoteRequest::reference_height`.
#define ISOPHOTE_REFERENCE_HEIGHT 1080

// Bit of features: `shaderStorageImageExtendedFormats` of `VkPhysicalDeviceFeatures`, for images of two floats.
#define ISOPHOTE_VULKAN_STORAGE_IMAGE_EXTENDED_FORMATS 1

// Bit of features: `timelineSemaphore` of `VkPhysicalDeviceVulkan12Features` or of the extension's own struct.
#define ISOPHOTE_VULKAN_TIMELINE_SEMAPHORE 2

// Recordings of one effect that may wait to be executed at once.
#define ISOPHOTE_VULKAN_MOST_IN_FLIGHT 64

// Status of a call: `ISOPHOTE_OK`, which is 0, or what went wrong. The message of the last failure is asked of the object that
// the call was made on (`graph_error`, `plan_error`, `device_error`); calls that make an object
// hand it out in their `error` argument.
typedef uint32_t IsophoteStatus;

// Kind of image that flows through a port. One of `ISOPHOTE_KIND_...`.
typedef uint32_t IsophoteKind;

// An input or output of a node.
typedef struct IsophotePort {
  // Stable name.
  const char *id;
  // One sentence.
  const char *doc;
  // Kind of image that it takes or gives.
  IsophoteKind kind;
  // 1 when the node works without it.
  uint32_t optional;
} IsophotePort;

// Type of a parameter. One of `ISOPHOTE_PARAM_...`.
typedef uint32_t IsophoteParamKind;

// Unit of a parameter. One of `ISOPHOTE_UNIT_...`.
typedef uint32_t IsophoteUnit;

// One option of a choice.
typedef struct IsophoteChoice {
  // Stable name.
  const char *id;
  // For people.
  const char *label;
} IsophoteChoice;

// One parameter of a node.
typedef struct IsophoteParam {
  // Stable name.
  const char *id;
  // For people.
  const char *label;
  // Text for people. Its first paragraph is a hint for panels, in artists' words and at most 160 bytes long; after an
  // empty line may follow documentation with symbols and sources.
  const char *doc;
  // Heading under which panels show it; empty for the node's own.
  const char *group;
  // Type.
  IsophoteParamKind kind;
  // Unit of a number.
  IsophoteUnit unit;
  // 1 when changing it may change the passes of a plan and not only uniform bytes.
  uint32_t structural;
  // Number of options of a choice; otherwise 0.
  uint32_t choice_count;
  // Options of a choice; otherwise null.
  const struct IsophoteChoice *choices;
  // The default: a number, 0 or 1, the index of an option, or R, G, B, A.
  double default_value[4];
  // Hard range of a number; values outside are refused.
  double minimum;
  // Hard range of a number.
  double maximum;
  // Range of a slider, within the hard range.
  double slider_minimum;
  // Range of a slider.
  double slider_maximum;
} IsophoteParam;

// The declaration of a node.
typedef struct IsophoteNode {
  // Stable name.
  const char *id;
  // For people.
  const char *label;
  // `structure`, `smoothing`, `lines`, `painting`, `coherence`, `colour` or `styles`.
  const char *group;
  // Text for people. Its first paragraph is a sentence for lists, in artists' words and at most 160 bytes long; after an
  // empty line follows documentation with symbols and sources.
  const char *doc;
  // Sections of the thesis, such as "3.4".
  const char *section;
  // Inputs.
  const struct IsophotePort *inputs;
  // Its parameters, in the order of panels.
  const struct IsophoteParam *params;
  // Number of inputs.
  uint32_t input_count;
  // Number of parameters.
  uint32_t param_count;
  // Output.
  struct IsophotePort output;
} IsophoteNode;

// All nodes of the library.
typedef struct IsophoteCatalogue {
  // The nodes, in the order of the catalogue.
  const struct IsophoteNode *nodes;
  // Number of nodes.
  uint32_t node_count;
} IsophoteCatalogue;

// The caller's buffer for a text that the library writes.
//
// The library writes at most `capacity` bytes with the closing zero, whole UTF-8 characters only, and
// puts into `length` how long the text is without the zero. With `data` null and `capacity` 0 it
// only sets `length`, which is a success.
typedef struct IsophoteText {
  // Where to write; may be null when `capacity` is 0.
  char *data;
  // Size of the buffer in bytes.
  size_t capacity;
  // Set by the library: length of the whole text in bytes.
  size_t length;
} IsophoteText;

// A graph of nodes; of one library in one process. Its number is never 0.
typedef struct IsophoteGraph {
  // The handle.
  uint64_t id;
} IsophoteGraph;

// Value of a parameter.
typedef struct IsophoteValue {
  // Type of the parameter.
  IsophoteParamKind kind;
  // Index of the selected option; otherwise 0.
  uint32_t choice_index;
  // Id of the selected option, valid for the life of the process; otherwise null.
  const char *choice;
  // A number in the first place, 0 or 1, the index of the option, or R, G, B, A.
  double number[4];
} IsophoteValue;

// Colour space of the numbers of a picture; the result has the same. One of `ISOPHOTE_SPACE_...`.
typedef uint32_t IsophoteSpace;

// Relation of colour to alpha, in the input and in the result. One of `ISOPHOTE_ALPHA_...`.
typedef uint32_t IsophoteAlpha;

// Request of the host for one picture of a graph.
typedef struct IsophoteRequest {
  // Width of the whole rendered picture in pixels, 1 to 65536.
  uint32_t width;
  // Height of the whole rendered picture in pixels, 1 to 65536.
  uint32_t height;
  // Rendered size over full size, above 0 and at most 64: 0.5 for a half-size proxy. Scales every
  // parameter in pixels.
  float scale;
  // Space of the colour that enters and leaves.
  IsophoteSpace space;
  // Relation of colour to alpha, entering and leaving.
  IsophoteAlpha alpha;
  // Which guides the host has, a sum of `ISOPHOTE_GUIDE_...`; connections to others count as open.
  // `process` goes by the images that it is given instead.
  uint32_t guides;
  // Column of the canonical picture, in full-size pixels, at which the left border of this one stands: 0 unless it is a
  // bounding box, or a data window within a display window. Noise, paper, hatching and grids are anchored to the
  // canonical picture. From -1000000 to 1000000.
  double origin_x;
  // Row of the canonical picture at which the top border stands.
  double origin_y;
  // Number of the frame; noise that the parameter `hold` lets last for so many frames is drawn anew by it.
  int64_t frame;
  // Height of a picture at which parameters in pixels are meant: 1080 gives the same picture the same look at any size.
  // At least 1/64 of the picture's own height. 0: they are pixels of the full-size picture.
  uint32_t reference_height;
  // Height of the canonical picture, in full-size pixels, which the reference is compared with: of the display window
  // where this is a data window. 0: the height of this picture.
  uint32_t canonical_height;
} IsophoteRequest;

// A half-open rectangle of pixels, x0 <= x < x1 and y0 <= y < y1, y down.
typedef struct IsophoteRect {
  // Left column, inclusive.
  int32_t x0;
  // Top row, inclusive.
  int32_t y0;
  // Right column, exclusive.
  int32_t x1;
  // Bottom row, exclusive.
  int32_t y1;
} IsophoteRect;

// Part of an input that a region of the result reads.
typedef struct IsophoteSupport {
  // The pixels needed, cut at the picture's border; empty when the input is not read.
  struct IsophoteRect window;
  // Greatest distance outside a region at which pixels are read, whichever region; 0 when `global`.
  uint32_t halo;
  // 1 when every pixel may depend on the whole picture, so that it cannot be cut into tiles.
  uint32_t global;
} IsophoteSupport;

// A graphics device of the library's own. Its number is 0 for none, which is the CPU.
typedef struct IsophoteDevice {
  // The handle.
  uint64_t id;
} IsophoteDevice;

// Storage of one sample of an image, in the machine's byte order. One of `ISOPHOTE_SAMPLE_...`.
typedef uint32_t IsophoteSample;

// Pixels of the host's, to be read. The library never keeps the pointer.
//
// Pixel (i, j) of the image, 0 <= i < width and 0 <= j < height, is pixel (x + i, y + j) of the
// picture and begins at `data + j * row_stride + i * channels * sample size`. No alignment is
// needed. Missing colour channels repeat the grey, missing alpha is 1. Of depth and object numbers
// the first channel is read; integer object numbers are taken as they are, and normals must be
// floats of three or four channels. Of motions, which are floats, the first two channels are read; what is not finite is
// unknown.
typedef struct IsophoteImage {
  // The first pixel of the top row, also where rows go upwards in memory.
  const void *data;
  // Bytes from one row to the one below it: at least a row's bytes, or at most the negative of
  // them where rows go upwards in memory.
  ptrdiff_t row_stride;
  // Storage of a sample.
  IsophoteSample sample;
  // Samples a pixel: 1 (grey), 3 (RGB) or 4 (RGBA); 2 to 4 of motions.
  uint32_t channels;
  // Columns held.
  uint32_t width;
  // Rows held.
  uint32_t height;
  // Column of the picture that the first column shows.
  int32_t x;
  // Row of the picture that the first row shows.
  int32_t y;
} IsophoteImage;

// An image that enters a graph.
typedef struct IsophoteInput {
  // `color`, `normal`, `depth`, `object_id`, `mask` or `flow`.
  const char *name;
  // The pixels.
  struct IsophoteImage image;
} IsophoteInput;

// Pixels of the host's, to be written; otherwise as `IsophoteImage`. A scalar result repeats itself
// in the colour channels, and surplus alpha is 1. The memory may overlap that of the inputs.
typedef struct IsophoteTarget {
  // The first pixel of the top row, also where rows go upwards in memory.
  void *data;
  // Bytes from one row to the one below it.
  ptrdiff_t row_stride;
  // Storage of a sample.
  IsophoteSample sample;
  // Samples a pixel: 1, 3 or 4.
  uint32_t channels;
  // Columns held.
  uint32_t width;
  // Rows held.
  uint32_t height;
  // Column of the picture that the first column shows.
  int32_t x;
  // Row of the picture that the first row shows.
  int32_t y;
} IsophoteTarget;

// One job of a batch, to be called by the host's threads: job `index` of `batch`, each once, at the
// same time or not.
typedef void (ISOPHOTE_ABI *IsophoteJob)(uint64_t batch, uint32_t index);

// The host's threads: calls `job(batch, 0)` ... `job(batch, jobs - 1)` and returns when all have
// returned. Called on the thread that called the library. Jobs left out are then done there; a job
// called later or with a wrong number does nothing.
typedef void (ISOPHOTE_ABI *IsophoteRun)(void *user, uint32_t jobs, IsophoteJob job, uint64_t batch);

// Receives the share of the work done, 0 to 1, on the thread that called the library.
typedef void (ISOPHOTE_ABI *IsophoteProgress)(void *user, float done);

// Asked often, on any thread; another value than 0 stops the work.
typedef uint32_t (ISOPHOTE_ABI *IsophoteCancelled)(void *user);

// Cost of one pass on the CPU.
typedef struct IsophotePassTime {
  // The kernel; valid during the call.
  const char *kernel;
  // Wall-clock time in seconds.
  double seconds;
  // Multiply-adds, or operations of like cost, by the kernel's own estimate.
  double operations;
  // Bytes of the images read and written, each once.
  uint64_t bytes;
  // Pixels written.
  uint64_t pixels;
} IsophotePassTime;

// Receives the time of each pass, in their order, when the work is done, on the thread that called
// the library. On a device it is not called.
typedef void (ISOPHOTE_ABI *IsophoteMeasured)(void *user, const struct IsophotePassTime *pass);

// Threads and callbacks of a call. Callbacks may be null, must return normally (no exception, no
// longjmp), and may themselves call the library.
typedef struct IsophoteControl {
  // Handed to every callback.
  void *user;
  // The host's threads, instead of the library's.
  IsophoteRun run;
  // Receives the progress.
  IsophoteProgress progress;
  // Asked whether to stop.
  IsophoteCancelled cancelled;
  // Receives the time of each pass; without it nothing is measured.
  IsophoteMeasured measured;
  // Threads of the library to use, or how many the host's `run` has; 0 for one per core, 1 for the
  // calling thread alone. At most 1024.
  uint32_t threads;
} IsophoteControl;

// The outcome of the work.
typedef struct IsophoteReport {
  // Samples of the inputs that were NaN or infinite and were replaced (by 0 and the largest half).
  uint64_t replaced;
  // Wall-clock time of the call in seconds.
  double seconds;
} IsophoteReport;

// A plan of passes as data. Its number is never 0.
typedef struct IsophotePlan {
  // The handle.
  uint64_t id;
} IsophotePlan;

// Result of an update of a plan. One of `ISOPHOTE_CHANGE_...`.
typedef uint32_t IsophoteChange;

// Purpose of a texture of a plan. One of `ISOPHOTE_ROLE_...`.
typedef uint32_t IsophoteRole;

// Texel format of a texture of a plan. One of `ISOPHOTE_FORMAT_...`.
typedef uint32_t IsophoteFormat;

// One texture of a plan. Two-dimensional, one mip level, one sample.
typedef struct IsophoteTexture {
  // Name of an input (`color`, `normal`, `depth`, `object_id`) or output (`output`); otherwise null.
  const char *name;
  // Purpose.
  IsophoteRole role;
  // Format of its texels. An input may have any format of as many channels that is read as floats.
  IsophoteFormat format;
  // Columns; at least so many.
  uint32_t width;
  // Rows; at least so many.
  uint32_t height;
  // 1 for tensors and the like, which need 32 bits; 0 for colours.
  uint32_t field;
  // Part of the picture, at its own pyramid level, that the texture holds; texel (0, 0) is
  // (x0, y0).
  struct IsophoteRect window;
} IsophoteTexture;

// One dispatch of a plan. Between two there must be a barrier where one reads or writes what the
// other wrote.
typedef struct IsophotePass {
  // The kernel; passes of the same kernel have the same shader in every language.
  const char *kernel;
  // Bytes of the uniform at binding 0.
  const void *grid;
  // Bytes of the uniform at binding 1; null for a kernel without parameters, whose shader has no
  // binding 1.
  const void *params;
  // Indices of the textures read, at bindings 2, 3, ...
  const uint32_t *inputs;
  // Indices of the textures written, at the bindings after those.
  const uint32_t *outputs;
  // Size of `grid` in bytes, a multiple of 16.
  uint32_t grid_size;
  // Size of `params` in bytes, a multiple of 4; round it up to 16 for the buffer.
  uint32_t params_size;
  // Number of textures read.
  uint32_t input_count;
  // Number of textures written.
  uint32_t output_count;
  // Workgroups to dispatch in x, y and z.
  uint32_t workgroups[3];
  // Size of a workgroup in x, y and z, as the shader declares it.
  uint32_t workgroup_size[3];
} IsophotePass;

// Language of a shader. One of `ISOPHOTE_LANGUAGE_...`.
typedef uint32_t IsophoteLanguage;

// Kind of resource at a binding of a shader. One of `ISOPHOTE_BINDING_...`.
typedef uint32_t IsophoteBindingKind;

// Where a binding of a kernel is found in a shader of some language.
typedef struct IsophoteBinding {
  // Name of the variable in the kernel.
  const char *name;
  // Number in the kernel, group 0: 0 the grid, 1 the parameters, from 2 the inputs, then the outputs.
  uint32_t binding;
  // Kind of resource.
  IsophoteBindingKind kind;
  // WGSL and SPIR-V: the binding of group or set 0, the same as `binding`. HLSL: the register, `b#`
  // for uniforms, `t#` for sampled, `u#` for storage. MSL: the index among buffers for uniforms,
  // among textures for the others. GLSL: the binding among uniform blocks, samplers or images.
  uint32_t slot;
} IsophoteBinding;

// A shader of a kernel. Everything in it is the library's and valid for the life of the process.
typedef struct IsophoteShader {
  // Text with a closing zero, or words of SPIR-V.
  const void *code;
  // Size of `code` in bytes, without the closing zero.
  size_t size;
  // Name of the entry point in this language.
  const char *entry_point;
  // Where everything is bound.
  const struct IsophoteBinding *bindings;
  // Number of bindings.
  uint32_t binding_count;
  // The language.
  IsophoteLanguage language;
} IsophoteShader;

// The functions of ABI version 1.
//
// Tags in brackets say where and when a function may be called.
//
// `any-thread`: from any thread at any time. `object-thread`: calls with the same handle must not overlap in time; with
// different handles they may. `not-while-processing`: so not while `process` runs on the same graph in another thread, nor
// from the functions that `process` calls. `also-while-processing`: even then. `needs-output`: once the graph has an
// output, that is after `graph_set_output`, `graph_create_single` or `graph_create_from_json`.
//
// Breaking a rule crashes nothing, but it is open which call comes first and whose message is the last. An object
// may be destroyed while a call uses it: the call ends as if it were still there.
//
// Ownership: pointers handed in are read or written during the call only. Pointers handed out are
// the library's, valid for the life of the process unless another end is named.
//
// Names and text are UTF-8 with a closing zero. Arguments named `error` may be null; they receive
// the message of a failure. Handles are never reused; what is handed out through a pointer is
// written on success only, but a handle is set to 0 first.
typedef struct IsophoteApi {
  // The ABI version that this table is of.
  uint32_t abi_version;
  // Size of this table in bytes.
  uint32_t struct_size;
  // Version of the library, such as "0.1.0".
  const char *version;
  // [any-thread] Name of a status in lower case, such as "out of range"; never null.
  const char *(ISOPHOTE_ABI *status_name)(IsophoteStatus status);
  // [any-thread] Ends the library's worker threads that are idle and gives back memory kept for
  // later calls. Both return by themselves when they are needed.
  IsophoteStatus (ISOPHOTE_ABI *trim)(void);
  // [any-thread] All nodes.
  IsophoteStatus (ISOPHOTE_ABI *catalogue)(struct IsophoteCatalogue *catalogue);
  // [any-thread] The node of an id; the message of a failure names the nearest.
  IsophoteStatus (ISOPHOTE_ABI *find_node)(const char *id,
                              struct IsophoteText *error,
                              const struct IsophoteNode **node);
  // [any-thread] Makes a graph without nodes. The caller owns it and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *graph_create)(struct IsophoteText *error, struct IsophoteGraph *graph);
  // [any-thread] Makes a graph of one node, index 0, named like its id: inputs that bear the name
  // of a picture that enters (`color`, `normal`, `depth`, `object_id`, `mask`, `flow`) are connected to it, and
  // the node's output is the graph's. The caller owns it and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *graph_create_single)(const char *node_id,
                                        struct IsophoteText *error,
                                        struct IsophoteGraph *graph);
  // [any-thread] Makes a graph from JSON (format `isophote-graph`, version 1). The caller owns it
  // and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *graph_create_from_json)(const char *json,
                                           struct IsophoteText *error,
                                           struct IsophoteGraph *graph);
  // [any-thread, also-while-processing] Destroys a graph. Plans made from it live on.
  IsophoteStatus (ISOPHOTE_ABI *graph_destroy)(struct IsophoteGraph graph);
  // [object-thread, not-while-processing] Message of the last failed call on the graph; empty before the first.
  IsophoteStatus (ISOPHOTE_ABI *graph_error)(struct IsophoteGraph graph, struct IsophoteText *text);
  // [object-thread, not-while-processing] Writes the graph as JSON, with the parameters that differ from their
  // defaults, into the caller's buffer.
  IsophoteStatus (ISOPHOTE_ABI *graph_to_json)(struct IsophoteGraph graph, struct IsophoteText *json);
  // [object-thread, not-while-processing] Adds the node `node_id` under a name of its own, and writes its index to
  // `node`.
  IsophoteStatus (ISOPHOTE_ABI *graph_add)(struct IsophoteGraph graph,
                              const char *name,
                              const char *node_id,
                              uint32_t *node);
  // [object-thread, not-while-processing] Number of nodes; their indices count from 0 in the order of addition.
  IsophoteStatus (ISOPHOTE_ABI *graph_count)(struct IsophoteGraph graph, uint32_t *count);
  // [object-thread, not-while-processing] Index of the node of a name.
  IsophoteStatus (ISOPHOTE_ABI *graph_find)(struct IsophoteGraph graph, const char *name, uint32_t *node);
  // [object-thread, not-while-processing] Name of a node within the graph, into the caller's buffer.
  IsophoteStatus (ISOPHOTE_ABI *graph_name)(struct IsophoteGraph graph, uint32_t node, struct IsophoteText *name);
  // [object-thread, not-while-processing] The declaration of a node.
  IsophoteStatus (ISOPHOTE_ABI *graph_spec)(struct IsophoteGraph graph,
                               uint32_t node,
                               const struct IsophoteNode **spec);
  // [object-thread, not-while-processing] Sets a parameter that is a number.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_float)(struct IsophoteGraph graph,
                                    uint32_t node,
                                    const char *param,
                                    double value);
  // [object-thread, not-while-processing] Sets a parameter that is a whole number, or a number.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_int)(struct IsophoteGraph graph,
                                  uint32_t node,
                                  const char *param,
                                  int32_t value);
  // [object-thread, not-while-processing] Sets a switch: 0 is off, any other value on.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_bool)(struct IsophoteGraph graph,
                                   uint32_t node,
                                   const char *param,
                                   uint32_t value);
  // [object-thread, not-while-processing] Sets a choice by the id of the option.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_choice)(struct IsophoteGraph graph,
                                     uint32_t node,
                                     const char *param,
                                     const char *option);
  // [object-thread, not-while-processing] Sets a colour: four numbers R, G, B, A, gamma-encoded sRGB, 0 to 1.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_color)(struct IsophoteGraph graph,
                                    uint32_t node,
                                    const char *param,
                                    const float *rgba);
  // [object-thread, not-while-processing] Sets a parameter of any type from text as a person writes it: `2.5`,
  // `true`, `scharr3`, `#12407b`, `0.1,0.2,0.5`.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_text)(struct IsophoteGraph graph,
                                   uint32_t node,
                                   const char *param,
                                   const char *text);
  // [object-thread, not-while-processing] Value of a parameter.
  IsophoteStatus (ISOPHOTE_ABI *graph_get)(struct IsophoteGraph graph,
                              uint32_t node,
                              const char *param,
                              struct IsophoteValue *value);
  // [object-thread, not-while-processing] Connects the output of node `from` to an input of node `to`, instead of
  // what was there. On failure the graph is as before.
  IsophoteStatus (ISOPHOTE_ABI *graph_connect)(struct IsophoteGraph graph,
                                  uint32_t from,
                                  uint32_t to,
                                  const char *port);
  // [object-thread, not-while-processing] Connects a picture that enters the graph (`color`, `normal`, `depth`,
  // `object_id`) to an input of node `to`.
  IsophoteStatus (ISOPHOTE_ABI *graph_connect_input)(struct IsophoteGraph graph,
                                        const char *input,
                                        uint32_t to,
                                        const char *port);
  // [object-thread, not-while-processing] Opens an input of node `to`.
  IsophoteStatus (ISOPHOTE_ABI *graph_disconnect)(struct IsophoteGraph graph, uint32_t to, const char *port);
  // [object-thread, not-while-processing] Makes the output of a node the graph's.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_output)(struct IsophoteGraph graph, uint32_t node);
  // [object-thread, not-while-processing, needs-output] What leaves the graph.
  IsophoteStatus (ISOPHOTE_ABI *graph_output_kind)(struct IsophoteGraph graph, IsophoteKind *kind);
  // [any-thread] Fills a request for a whole picture: full scale, sRGB, premultiplied, no guides.
  IsophoteStatus (ISOPHOTE_ABI *request_init)(uint32_t width, uint32_t height, struct IsophoteRequest *request);
  // [object-thread, not-while-processing, needs-output] What `region` of the result (null: the whole picture) reads of the input
  // `input`, or of all inputs together when that is null.
  IsophoteStatus (ISOPHOTE_ABI *graph_support)(struct IsophoteGraph graph,
                                  const struct IsophoteRequest *request,
                                  const struct IsophoteRect *region,
                                  const char *input,
                                  struct IsophoteSupport *support);
  // [object-thread, needs-output] Computes `region` of the result (null: the whole picture) and writes it
  // to `target`, which must hold it; other pixels stay as they are, and on any failure all do.
  //
  // `inputs` are `input_count` images that must each hold what `graph_support` names. Guides that
  // are not given count as open; inputs that the graph does not read are ignored. `device` is 0 for
  // the CPU, where a region is the same bit for bit whether it is computed alone or not. `control`
  // and `report` may be null. Memory is kept with the graph for the next call of the same request.
  IsophoteStatus (ISOPHOTE_ABI *process)(struct IsophoteGraph graph,
                            struct IsophoteDevice device,
                            const struct IsophoteRequest *request,
                            const struct IsophoteInput *inputs,
                            uint32_t input_count,
                            const struct IsophoteRect *region,
                            const struct IsophoteTarget *target,
                            const struct IsophoteControl *control,
                            struct IsophoteReport *report);
  // [any-thread, also-while-processing, needs-output] Makes a plan that computes `region` (null: the whole picture) of what `graph` gives
  // now, as data for the host's own graphics device. The caller owns it and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *plan_create)(struct IsophoteGraph graph,
                                const struct IsophoteRequest *request,
                                const struct IsophoteRect *region,
                                struct IsophoteText *error,
                                struct IsophotePlan *plan);
  // [any-thread] Destroys a plan and with it every texture and pass that it handed out.
  IsophoteStatus (ISOPHOTE_ABI *plan_destroy)(struct IsophotePlan plan);
  // [object-thread] Message of the last failed call on the plan; empty before the first.
  IsophoteStatus (ISOPHOTE_ABI *plan_error)(struct IsophotePlan plan, struct IsophoteText *text);
  // [object-thread] Takes over the parameters and connections that `graph` has now, and
  // reports what changed. `request` is null for the plan's own, or another of the same size: its frame and origin
  // change uniforms only. When only uniforms changed, the bytes that `IsophotePass` points to were
  // rewritten in place; when the structure changed, textures and passes must be asked for again
  // and earlier pointers are void. After a failure the plan is as before.
  IsophoteStatus (ISOPHOTE_ABI *plan_update)(struct IsophotePlan plan,
                                struct IsophoteGraph graph,
                                const struct IsophoteRequest *request,
                                IsophoteChange *change);
  // [object-thread] All textures: inputs, outputs, then transients. The array is the plan's,
  // until it is destroyed or its structure changes.
  IsophoteStatus (ISOPHOTE_ABI *plan_textures)(struct IsophotePlan plan,
                                  const struct IsophoteTexture **textures,
                                  uint32_t *count);
  // [object-thread] All passes in the order of execution. The array and what it points to are
  // the plan's, until it is destroyed or its structure changes.
  IsophoteStatus (ISOPHOTE_ABI *plan_passes)(struct IsophotePlan plan,
                                const struct IsophotePass **passes,
                                uint32_t *count);
  // [object-thread] The shader of pass `pass` in a language, translated when it is first asked
  // for. It is valid for the life of the process.
  IsophoteStatus (ISOPHOTE_ABI *plan_shader)(struct IsophotePlan plan,
                                uint32_t pass,
                                IsophoteLanguage language,
                                const struct IsophoteShader **shader);
  // [any-thread] Opens a graphics device of the library's own. `adapter` is `gpu` for hardware only,
  // `software` for a driver on the CPU, or a part of the adapter's name; null takes the best there
  // is. Graphics drivers are loaded now and not before. The caller owns it and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *device_create)(const char *adapter,
                                  struct IsophoteText *error,
                                  struct IsophoteDevice *device);
  // [any-thread] Destroys a device, once the calls that use it have ended.
  IsophoteStatus (ISOPHOTE_ABI *device_destroy)(struct IsophoteDevice device);
  // [object-thread] Message of the last failed call on the device; empty before the first.
  IsophoteStatus (ISOPHOTE_ABI *device_error)(struct IsophoteDevice device, struct IsophoteText *text);
  // [object-thread] Name of the device's adapter, into the caller's buffer, and whether it
  // computes on the CPU (1). Each may be null.
  IsophoteStatus (ISOPHOTE_ABI *device_name)(struct IsophoteDevice device,
                                struct IsophoteText *name,
                                uint32_t *software);
  // [any-thread] What an extension of this table offers, by its name: a struct that the extension's own header declares,
  // valid for the life of the process. Null for names that this library does not know, an empty one and null.
  const void *(ISOPHOTE_ABI *extension)(const char *id);
} IsophoteApi;

// The library's one symbol, `isophote_api`, as a host looks it up.
//
// [any-thread] Returns the table of ABI version `abi_version`, or null when this library has none
// of that number. The table is the library's and valid until the library is unloaded.
typedef const struct IsophoteApi *(ISOPHOTE_ABI *IsophoteEntry)(uint32_t abi_version);

// State that is kept of a sequence of frames. Its number is never 0.
typedef struct IsophoteSequence {
  // The handle.
  uint64_t id;
} IsophoteSequence;

// Callback by which the library asks for the images of frames.
typedef struct IsophoteFrames {
  // Handed to both functions.
  void *user;
  // Gives the image that a graph's input, such as "color" or "motion", shows in a frame: fills `image` and returns 1,
  // or returns 0 where there is none. Neighbouring frames are asked for from the nearest on, up to the first that has
  // no colour; that one and those behind it count for nothing. The image stays valid until `release` or, without it,
  // until `sequence_process` returns. Called on the calling thread, and must not call functions on the sequence.
  int32_t (ISOPHOTE_ABI *input)(void *user, const char *input, int64_t frame, struct IsophoteImage *image);
  // Takes back an image, which was copied. May be null.
  void (ISOPHOTE_ABI *release)(void *user, const char *input, int64_t frame, const struct IsophoteImage *image);
} IsophoteFrames;

// Images that a plan for frames in order reads and gives besides those of one frame.
//
// The plan's textures of stages: an output "stage0" is what the frame found, an input "stage0@-1" what the frame before
// did, and so on. A host hands each frame's outputs to the frames after it, and other inputs, such as "depth@-1",
// likewise.
typedef struct IsophoteHistory {
  // Frames before this one that are known, at most those that `frames` names.
  uint32_t past;
  // Longest motion from frame to frame that counts, in pixels of the full-size picture; 0 for the library's own.
  float max_motion;
} IsophoteHistory;

// The functions of the extension "isophote.sequence/1". Tags and ownership are those of `IsophoteApi`.
typedef struct IsophoteSequenceApi {
  // Size of this table in bytes.
  uint32_t struct_size;
  // [any-thread, needs-output] Frames before and after its own that a frame of the graph depends on; 0 and 0 for
  // graphs of stills.
  IsophoteStatus (ISOPHOTE_ABI *frames)(struct IsophoteGraph graph, uint32_t *past, uint32_t *future);
  // [any-thread] Makes a sequence, which keeps stages of frames in at most `memory` bytes; with 0 it keeps none, and
  // computes them again for each frame. `max_motion` is the longest motion from frame to frame that counts, in pixels
  // of the full-size picture; 0 for the library's own. The caller owns it and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *create)(uint64_t memory,
                           float max_motion,
                           struct IsophoteText *error,
                           struct IsophoteSequence *sequence);
  // [any-thread] Destroys a sequence, once the calls that use it have ended.
  IsophoteStatus (ISOPHOTE_ABI *destroy)(struct IsophoteSequence sequence);
  // [object-thread, also-while-processing] Message of the last failed call on the sequence; empty before the first.
  IsophoteStatus (ISOPHOTE_ABI *error)(struct IsophoteSequence sequence, struct IsophoteText *text);
  // [any-thread] Gives back the memory of all stages. Called when frames of the same numbers show something else, too.
  IsophoteStatus (ISOPHOTE_ABI *forget)(struct IsophoteSequence sequence);
  // [any-thread, needs-output] `IsophoteApi::process` of the frame that the request names, with inputs pulled from
  // `frames` as far as they are needed; `guides` of the request says which there are, in all frames alike. Calls on
  // one sequence wait for each other. A frame's pixels depend on the frames around it that are known, and never on
  // which were computed before. Stages are kept where `region` is the whole picture, or null.
  IsophoteStatus (ISOPHOTE_ABI *process)(struct IsophoteSequence sequence,
                            struct IsophoteGraph graph,
                            struct IsophoteDevice device,
                            const struct IsophoteRequest *request,
                            const struct IsophoteFrames *frames,
                            const struct IsophoteRect *region,
                            const struct IsophoteTarget *target,
                            const struct IsophoteControl *control,
                            struct IsophoteReport *report);
  // [any-thread, needs-output] `IsophoteApi::plan_create` of a frame in order.
  IsophoteStatus (ISOPHOTE_ABI *plan_create)(struct IsophoteGraph graph,
                                const struct IsophoteRequest *request,
                                const struct IsophoteHistory *history,
                                const struct IsophoteRect *region,
                                struct IsophoteText *error,
                                struct IsophotePlan *plan);
} IsophoteSequenceApi;

// Precision in which graphics devices compute a graph. One of `ISOPHOTE_PRECISION_...`.
typedef uint32_t IsophotePrecision;

// The functions of the extension "isophote.precision/1". Tags and ownership are those of `IsophoteApi`.
typedef struct IsophotePrecisionApi {
  // Bytes of this struct.
  uint32_t struct_size;
  // [any-thread] Sets how precisely graphics devices compute the graph from the next plan, update of a plan or call of
  // `process` on; exactly, unless set. CPUs always compute exactly. It is no part of the graph as text.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_precision)(struct IsophoteGraph graph, IsophotePrecision precision);
} IsophotePrecisionApi;

// The functions of the extension "isophote.memory/1". Tags and ownership are those of `IsophoteApi`.
//
// What `process` computes on the CPU takes memory beside the host's images. A picture for which that would be more than
// the bound goes through all passes by rows, and then takes a copy of the result in its own format besides. The bits are
// the same. Fewer rows at a time take longer, and there are always some: where even those need more than the bound,
// they take it.
typedef struct IsophoteMemoryApi {
  // Bytes of this struct.
  uint32_t struct_size;
  // [any-thread] Bounds the bytes that images of a call of `process` may take on the CPU, from the next call on; 0 lets the
  // library choose, which is what it does unless told. It is no part of the graph as text.
  IsophoteStatus (ISOPHOTE_ABI *graph_set_memory)(struct IsophoteGraph graph, uint64_t bytes);
  // [object-thread, not-while-processing, needs-output] Bytes that images of a call of `process` with this request take on
  // the CPU: those of the plan, without the host's and without a copy of the result.
  IsophoteStatus (ISOPHOTE_ABI *graph_memory)(struct IsophoteGraph graph,
                                 const struct IsophoteRequest *request,
                                 const struct IsophoteRect *region,
                                 uint64_t *bytes);
} IsophoteMemoryApi;

// A picture that may enter a graph.
typedef struct IsophoteGuide {
  // Name of the graph's input, such as "normal".
  const char *id;
  // For people.
  const char *label;
  // One sentence.
  const char *doc;
  // Kind of the picture.
  IsophoteKind kind;
  // Values a pixel.
  uint32_t channels;
  // Bit in `IsophoteRequest::guides`.
  uint32_t bit;
} IsophoteGuide;

// The functions of the extension "isophote.guides/1". Tags and ownership are those of `IsophoteApi`.
typedef struct IsophoteGuidesApi {
  // Size of this table in bytes.
  uint32_t struct_size;
  // [any-thread] All pictures that may enter a graph beside the colour.
  IsophoteStatus (ISOPHOTE_ABI *guides)(const struct IsophoteGuide **guides, uint32_t *count);
} IsophoteGuidesApi;

// Size of a picture in square pixels.
typedef struct IsophoteSquareSize {
  // Columns.
  uint32_t width;
  // Rows.
  uint32_t height;
  // Scale of a request for them. Full size is that of the picture's rows where pixels are wider than high, and its
  // `origin_x` counts in that unit too.
  float scale;
} IsophoteSquareSize;

// The functions of the extension "isophote.pixel_aspect/1". Tags and ownership are those of `IsophoteApi`.
//
// Nodes know lengths in pixels, the same in every direction. A host whose pixels are not square makes its images so, asks for
// the result of them, and makes that its own pixels again. Both ways take a pixel for the mean over its area; where a whole
// number of square pixels makes one of the host's, there and back is no change. `aspect` is the width of a pixel over its
// height, 0.01 to 100.
typedef struct IsophotePixelAspectApi {
  // Bytes of this struct.
  uint32_t struct_size;
  // [any-thread] Size in square pixels, which are as fine as the finer side of the picture's own. The picture's own size
  // where those are square as far as anyone can see.
  IsophoteStatus (ISOPHOTE_ABI *square_size)(uint32_t width,
                                uint32_t height,
                                double aspect,
                                struct IsophoteSquareSize *size);
  // [any-thread] Makes square pixels of the whole picture `image`, which is the input of this name: "color", or a guide,
  // whose target holds 32-bit floats. Vectors of motion are counted in square pixels then. `alpha` is that of the
  // colour. `threads` are as in `IsophoteControl`. `replaced` receives how many samples were not finite, and may be null.
  IsophoteStatus (ISOPHOTE_ABI *to_square)(const char *input,
                              const struct IsophoteImage *image,
                              double aspect,
                              IsophoteAlpha alpha,
                              uint32_t threads,
                              const struct IsophoteTarget *target,
                              uint64_t *replaced,
                              struct IsophoteText *error);
  // [any-thread] Makes the host's pixels of a result in square ones; the size of `target` is the picture's.
  IsophoteStatus (ISOPHOTE_ABI *from_square)(const struct IsophoteImage *image,
                                double aspect,
                                IsophoteAlpha alpha,
                                uint32_t threads,
                                const struct IsophoteTarget *target,
                                struct IsophoteText *error);
} IsophotePixelAspectApi;

// A look that ships with the library.
typedef struct IsophoteLook {
  // Stable name. `look:` and this is the name of the look where a style is named.
  const char *id;
  // The text of its preset.
  const char *preset;
} IsophoteLook;

// Fault of a preset, in parts that together make one line: `place: problem; fix`.
//
// The buffers are the caller's; what does not fit is cut. All are filled when a function of this extension fails, and
// none when it succeeds.
typedef struct IsophoteFault {
  // File and parameter at fault; empty where the caller knows them alone.
  struct IsophoteText place;
  // Problem with it.
  struct IsophoteText problem;
  // Way to put it right; empty where the problem says that.
  struct IsophoteText fix;
  // Id of the node whose declaration says what is possible; empty for none.
  struct IsophoteText node;
} IsophoteFault;

// The parameters of a graph as a preset sets them. Its number is never 0.
typedef struct IsophoteStyle {
  // The handle.
  uint64_t id;
} IsophoteStyle;

// The functions of the extension "isophote.presets/1". Tags and ownership are those of `IsophoteApi`.
//
// Arguments named `fault` may be null. `place` names a text in messages, as the path of its file would.
typedef struct IsophotePresetsApi {
  // Size of this table in bytes.
  uint32_t struct_size;
  // [any-thread] All looks that ship, in the order of lists.
  IsophoteStatus (ISOPHOTE_ABI *looks)(const struct IsophoteLook **looks, uint32_t *count);
  // [any-thread] The colour that a person wrote, `#rrggbb`, `#rrggbbaa`, or three or four numbers with commas between:
  // four numbers R, G, B, A, gamma-encoded sRGB, 0 to 1.
  IsophoteStatus (ISOPHOTE_ABI *color)(const char *text, float *rgba, struct IsophoteFault *fault);
  // [any-thread] Reads a preset, and writes what it holds as JSON of one form into the caller's buffer:
  // `{"preset": {"title": {"name", "about", "tags"}, "style", "lengths", "params", "objects"}, "faults": [...]}`. A parameter is
  // its name and `{"still": text}` or `{"keys": {"keys": [[frame, text], ...], "step"}}`, a fault its four parts. An object is
  // `{"rule", "things", "control"}`: the rule as the file has it, the things that it matches, and what a control map has where
  // they are, four numbers or nulls. The preset is null where the text is a graph. Fails for text that is no JSON object.
  IsophoteStatus (ISOPHOTE_ABI *read)(const char *json,
                         const char *place,
                         struct IsophoteText *report,
                         struct IsophoteFault *fault);
  // [any-thread] Writes the text of a file from a preset in the form of `read`, where objects have their rule alone.
  IsophoteStatus (ISOPHOTE_ABI *write)(const char *preset, struct IsophoteText *json, struct IsophoteFault *fault);
  // [any-thread] All faults of a preset, also those that the nodes find in its values, as a JSON array like that of `read`.
  // `graph` is the text of the graph file that the preset names, or null where it names none.
  IsophoteStatus (ISOPHOTE_ABI *check)(const char *json,
                          const char *place,
                          const char *graph,
                          struct IsophoteText *faults,
                          struct IsophoteFault *fault);
  // [any-thread] Opens the node of an id, fed with what it needs and no picture gives, or the look that is named
  // `look:ID`. The caller owns the style and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *style_create)(const char *name,
                                 struct IsophoteStyle *style,
                                 struct IsophoteFault *fault);
  // [any-thread] Opens a preset, or a graph as `graph_create_from_json` takes it. `graph` is the text of the graph file
  // that the preset names, or null where it names none. The caller owns the style and destroys it.
  //
  // Rules of a preset for things count in requests with what tells these: those by number, such as `id:3`, with numbers of
  // objects, those by whole names, such as `cryptomatte:hero`, with a Cryptomatte. What they say is added to the control map and to
  // the colours of lines, and looks of things are laid over the result. `style_left_out` tells which rules cannot be followed. A host
  // that follows all of them by itself learns of them by `read`, and opens the preset without its objects.
  IsophoteStatus (ISOPHOTE_ABI *style_create_from_json)(const char *json,
                                           const char *place,
                                           const char *graph,
                                           struct IsophoteStyle *style,
                                           struct IsophoteFault *fault);
  // [any-thread] Destroys a style. Graphs made of it live on.
  IsophoteStatus (ISOPHOTE_ABI *style_destroy)(struct IsophoteStyle style);
  // [object-thread] Makes the graph of a style with the values of its parameters; those with keyframes have that of the
  // first. The caller owns it and destroys it.
  IsophoteStatus (ISOPHOTE_ABI *style_graph)(struct IsophoteStyle style,
                                struct IsophoteGraph *graph,
                                struct IsophoteFault *fault);
  // [object-thread] The reference height of requests for a style: `ISOPHOTE_REFERENCE_HEIGHT`, or 0 where lengths are
  // pixels of the picture.
  IsophoteStatus (ISOPHOTE_ABI *style_reference_height)(struct IsophoteStyle style, uint32_t *height);
  // [object-thread] Sets a parameter of the style's graph for all frames, from text as a person writes it. `name` is its
  // id, or `node.id` for one node of a graph. `node`, which may be null, receives the index of its node.
  IsophoteStatus (ISOPHOTE_ABI *style_set)(struct IsophoteStyle style,
                              struct IsophoteGraph graph,
                              const char *name,
                              const char *text,
                              uint32_t *node,
                              struct IsophoteFault *fault);
  // [object-thread] Gives parameters with keyframes their values at a frame in the style's graph. `changes`, which may be
  // null, receives 1 where there are such, and 0 otherwise.
  IsophoteStatus (ISOPHOTE_ABI *style_at_frame)(struct IsophoteStyle style,
                                   struct IsophoteGraph graph,
                                   int64_t frame,
                                   uint32_t *changes,
                                   struct IsophoteFault *fault);
  // [object-thread] The value at a frame, as text, of the parameter with keyframes that the preset names so.
  IsophoteStatus (ISOPHOTE_ABI *style_value)(struct IsophoteStyle style,
                                const char *name,
                                int64_t frame,
                                struct IsophoteText *text,
                                struct IsophoteFault *fault);
  // [object-thread] Frames of all keys in ascending order: as many as there are into `count`, and as many of them as
  // `capacity` has room for into `frames`, which may be null when that is 0.
  IsophoteStatus (ISOPHOTE_ABI *style_frames)(struct IsophoteStyle style,
                                 int64_t *frames,
                                 uint32_t capacity,
                                 uint32_t *count);
  // [object-thread] What the style's graph does not follow of its preset's rules for things, and why: a list of faults, as
  // `check` has them, whose places are in the words of the rules. Names with `*` or `?` are followed by hosts alone, which know
  // all names.
  IsophoteStatus (ISOPHOTE_ABI *style_left_out)(struct IsophoteStyle style,
                                   struct IsophoteText *faults,
                                   struct IsophoteFault *fault);
} IsophotePresetsApi;

// Features and extensions that a device must be created with.
typedef struct IsophoteVulkanNeeds {
  // Features to enable, a sum of `ISOPHOTE_VULKAN_...` bits.
  uint32_t features;
  // Number of device extensions to enable.
  uint32_t extension_count;
  // Their names.
  const char *const *extensions;
} IsophoteVulkanNeeds;

// A function of Vulkan, to be cast to its own type.
typedef void (ISOPHOTE_ABI *IsophoteVulkanFunction)(void);

// `vkGetInstanceProcAddr`, with the instance as a plain pointer.
typedef IsophoteVulkanFunction (ISOPHOTE_ABI *IsophoteVulkanLoader)(void *instance, const char *name);

// A Vulkan device of the host's, which outlives the object made on it, as all does that is named here. Handles are cast to
// plain pointers and numbers, so that this header needs no other.
typedef struct IsophoteVulkanHost {
  // Finds all functions of Vulkan.
  IsophoteVulkanLoader get_instance_proc_addr;
  // `VkInstance`.
  void *instance;
  // `VkPhysicalDevice`.
  void *physical_device;
  // `VkDevice`.
  void *device;
  // `VkQueue` for `submit`, of the family `queue_family`; null for a host that only records.
  void *queue;
  // The version that instance and device are used with, such as `VK_API_VERSION_1_2`: at least 1.1.
  uint32_t api_version;
  // Family of the queues that all commands are executed on; it has compute.
  uint32_t queue_family;
  // Features that the device was created with, a sum of `ISOPHOTE_VULKAN_...` bits.
  uint32_t features;
  // Number of device extensions that it was created with.
  uint32_t extension_count;
  // Their names; may be null when there are none.
  const char *const *extensions;
  // `VkSemaphore` of the timeline type, by which the library knows without waiting what has been executed.
  uint64_t timeline;
  // `VkPipelineCache` of the host's, which shaders are compiled with; 0 for none. Vulkan itself guards it, or the host
  // makes no effects while it uses it elsewhere.
  uint64_t pipeline_cache;
  // Handed to both functions.
  void *user;
  // Called by `submit`, on its thread, before it touches the queue: the host's lock of it. May be null where no other
  // thread uses the queue meanwhile. Must not call functions of this extension.
  void (ISOPHOTE_ABI *lock_queue)(void *user);
  // Called when the queue was touched.
  void (ISOPHOTE_ABI *unlock_queue)(void *user);
} IsophoteVulkanHost;

// A Vulkan device of the host's, with the shaders compiled for it. Its number is never 0.
typedef struct IsophoteVulkan {
  // The handle.
  uint64_t id;
} IsophoteVulkan;

// A graph made ready for pictures of one size on a Vulkan device of the host's. Its number is never 0.
typedef struct IsophoteVulkanEffect {
  // The handle.
  uint64_t id;
} IsophoteVulkanEffect;

// An image of the host's and a view of it, which outlive the execution of what they are recorded in. Filters read and write
// them where they are.
//
// Inputs were created with `VK_IMAGE_USAGE_SAMPLED_BIT`, and their views have a format that is read as floats. `normal`,
// `flow` and `rest_position` need four channels, `color` three or four, `motion` and `motion_forward` two; the others one.
// `normal` needs signed or floating samples, and `depth`, `object_id`, `rest_position` and motions floating ones. Views of an
// sRGB format give linear light, which the request's `space` must say. NaN and infinities are not replaced.
//
// The output is written by the last filter itself where its view has the format `VK_FORMAT_R32G32B32A32_SFLOAT` (for
// graphs that give one channel, `VK_FORMAT_R32_SFLOAT`; for colours in less than exact precision,
// `VK_FORMAT_R16G16B16A16_SFLOAT`) and the image was created with `VK_IMAGE_USAGE_STORAGE_BIT` and
// `VK_IMAGE_USAGE_SAMPLED_BIT`. Any other colour format needs `VK_IMAGE_USAGE_TRANSFER_DST_BIT`: the result is then blitted
// there, converted as blits convert, which needs a queue family with graphics.
typedef struct IsophoteVulkanImage {
  // An input of the graph, such as `color`, or `output`. Inputs that the graph does not read are ignored.
  const char *name;
  // `VkImage`, of two dimensions and one sample.
  uint64_t image;
  // `VkImageView` of one level and layer of the colour aspect, of the type 2D, without swizzling; 0 for an output that
  // is blitted to.
  uint64_t view;
  // `VkFormat` of the view, or of the image that is blitted to.
  uint32_t format;
  // `VkImageUsageFlags` that the image was created with.
  uint32_t usage;
  // Columns of the level: at least those of the picture, whose pixel (0, 0) is texel (0, 0).
  uint32_t width;
  // Rows of the view, likewise.
  uint32_t height;
  // Level that the view shows.
  uint32_t level;
  // Layer that the view shows.
  uint32_t layer;
  // `VkImageLayout` of the level and layer before: of an input anything but undefined; best
  // `VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL`, or `VK_IMAGE_LAYOUT_GENERAL`, which take no transition.
  uint32_t layout_before;
  // `VkImageLayout` that they are left in.
  uint32_t layout_after;
} IsophoteVulkanImage;

// A semaphore that a submission waits for or signals.
typedef struct IsophoteVulkanSemaphore {
  // `VkSemaphore`.
  uint64_t semaphore;
  // Value of a timeline; ignored of binary ones.
  uint64_t value;
} IsophoteVulkanSemaphore;

// The functions of the extension "isophote.vulkan/1", which is there on all systems but Apple's. Tags and ownership are
// those of `IsophoteApi`.
//
// The library never waits for the GPU, and never touches a queue but in `submit`, between the host's two functions. What
// commands use (images for intermediate results, uniforms, bindings) is kept until the timeline has the value that the
// host gave with them. An effect has one set of intermediate images: its recordings are executed one after another, in the
// order of a queue or behind semaphores, and any number of them, up to `ISOPHOTE_VULKAN_MOST_IN_FLIGHT`, may be in flight.
// Frames after the first few make no Vulkan objects and take no memory of the device. All effects of an object share its
// timeline; a host with several queues makes an object for each.
//
// After `ISOPHOTE_ERROR_DEVICE` that says that the device is lost, destroy effects and object, and make them on another.
// After any other error go on: nothing was recorded or submitted.
typedef struct IsophoteVulkanApi {
  // Size of this table in bytes.
  uint32_t struct_size;
  // [any-thread] What a device that is used with `api_version` (at least 1.1) must be created with. What is handed out
  // lives as long as the process. The queue family needs compute, and graphics where outputs are blitted.
  IsophoteStatus (ISOPHOTE_ABI *needs)(uint32_t api_version,
                          struct IsophoteText *error,
                          struct IsophoteVulkanNeeds *needs);
  // [any-thread] Makes an object on a device of the host's. The message of a failure names what the device lacks.
  // The caller owns it, and destroys it before the device.
  IsophoteStatus (ISOPHOTE_ABI *create)(const struct IsophoteVulkanHost *host,
                           struct IsophoteText *error,
                           struct IsophoteVulkan *vulkan);
  // [any-thread] Destroys an object and all that its effects hold; their handles can then only be destroyed. All
  // recordings have been executed, or will never be, as for `vkDestroyDevice`.
  IsophoteStatus (ISOPHOTE_ABI *destroy)(struct IsophoteVulkan vulkan);
  // [any-thread, needs-output] Makes a graph ready for the size, spaces and guides of a request. Compiles shaders that the
  // object has not yet compiled, which takes milliseconds to seconds; other threads may record meanwhile. The caller
  // owns it and destroys it. The graph may be destroyed.
  IsophoteStatus (ISOPHOTE_ABI *effect_create)(struct IsophoteVulkan vulkan,
                                  struct IsophoteGraph graph,
                                  const struct IsophoteRequest *request,
                                  struct IsophoteText *error,
                                  struct IsophoteVulkanEffect *effect);
  // [any-thread] Destroys an effect. What its recordings use is kept until they have been executed.
  IsophoteStatus (ISOPHOTE_ABI *effect_destroy)(struct IsophoteVulkanEffect effect);
  // [object-thread] Message of the last failed call on the effect; empty before the first.
  IsophoteStatus (ISOPHOTE_ABI *effect_error)(struct IsophoteVulkanEffect effect, struct IsophoteText *text);
  // [object-thread, needs-output] Takes over the parameters of the graph and the request (null for the one before) for
  // the next recording, also while commands are in flight. With `ISOPHOTE_CHANGE_UNIFORMS` no Vulkan object was made;
  // with `ISOPHOTE_CHANGE_STRUCTURE`, which another size always is, intermediate images are others, and shaders that are
  // new were compiled. After a failure the effect is as it was.
  IsophoteStatus (ISOPHOTE_ABI *effect_update)(struct IsophoteVulkanEffect effect,
                                  struct IsophoteGraph graph,
                                  const struct IsophoteRequest *request,
                                  IsophoteChange *change);
  // [object-thread] Records the effect into a `VkCommandBuffer` of the host's, which is in the recording state and
  // outside of a render pass; to be executed once. Barriers before and after order it with all commands around it on
  // the queue, so that the host needs none. Afterwards other pipelines and descriptor sets are bound for compute.
  //
  // `value` is what the timeline will have once the commands have been executed: the host signals it with the
  // submission of the command buffer or with a later one. It is above what the timeline has now.
  IsophoteStatus (ISOPHOTE_ABI *record)(struct IsophoteVulkanEffect effect,
                           void *command_buffer,
                           const struct IsophoteVulkanImage *images,
                           uint32_t image_count,
                           uint64_t value);
  // [object-thread] Records the effect into a command buffer of the library's and submits it to the host's queue: it
  // begins after `waits`, signals `signals` when it is done, and sets the timeline to `value`. Values of the timeline
  // grow from submission to submission.
  IsophoteStatus (ISOPHOTE_ABI *submit)(struct IsophoteVulkanEffect effect,
                           const struct IsophoteVulkanImage *images,
                           uint32_t image_count,
                           const struct IsophoteVulkanSemaphore *waits,
                           uint32_t wait_count,
                           const struct IsophoteVulkanSemaphore *signals,
                           uint32_t signal_count,
                           uint64_t value);
} IsophoteVulkanApi;

// [any-thread] Returns the table of ABI version `abi_version`, or null when this library has none of
// that number. The table is the library's and valid for the life of the process.
ISOPHOTE_IMPORT const struct IsophoteApi *ISOPHOTE_ABI isophote_api(uint32_t abi_version);

#ifdef __cplusplus
} /* extern "C" */
#endif

#endif  /* ISOPHOTE_H */
