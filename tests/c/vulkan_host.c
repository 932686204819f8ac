/* Stylizes every frame of a renderer with Vulkan on the renderer's own device, from and to its images, without a copy: an
 * example to copy.
 *
 * vulkan_host LIBRARY SCENE.spv FRAMES SCALE [OUT.ppm]
 *
 * What an engine needs: open_filter once, update on every frame, and then either record, into a command buffer of its own
 * (render_recorded), or submit, to its queue (render_submitted). All else here is the renderer (vulkan_scene.h), or makes
 * life hard for the library: frames are in flight at once, windows change their size, another thread uses the queue and
 * makes effects, the library is unloaded and loaded again. Now and then a frame is compared with what `process` makes of the
 * same images. The program fails when a sample differs or a validation layer complains.
 */
/* For nanosleep. */
#define _POSIX_C_SOURCE 200809L

#include "ppm.h"
#include "vulkan_scene.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#define IN_FLIGHT 3
/* Frames from one size to the next, and from one comparison to the next. */
#define RESIZED 70
#define COMPARED 23
/* Times that the library is loaded. */
#define ROUNDS 2

static const uint32_t SIZES[][2] = {{96, 64}, {65, 39}, {80, 45}, {48, 60}};
static const char *const NAMES[DRAWN] = {"color", "normal", "depth", "object_id"};
static const uint32_t CHANNELS[DRAWN] = {4, 4, 1, 1};
static const IsophoteSample SAMPLES[DRAWN] = {ISOPHOTE_SAMPLE_F16, ISOPHOTE_SAMPLE_F16, ISOPHOTE_SAMPLE_F32,
                                              ISOPHOTE_SAMPLE_F32};

/* The renderer. */
typedef struct Host {
    Gpu gpu;
    Scene scene;
    Frame frames[IN_FLIGHT];
    /* Results of frames that are recorded. */
    Buffer copies[IN_FLIGHT];
    /* Timelines: a frame is drawn, a frame is stylized. */
    VkSemaphore drawn, done;
    uint64_t value;
    pthread_mutex_t queue;
    uint32_t scale, width, height;
} Host;

/* The library with one graph on the renderer's device. */
typedef struct Filter {
    void *library;
    const IsophoteApi *api;
    const IsophoteVulkanApi *vulkans;
    const IsophotePrecisionApi *precisions;
    IsophoteGraph graph;
    IsophoteRequest request;
    IsophoteVulkan vulkan;
    IsophoteVulkanEffect effect;
    /* What it is compared with. */
    IsophoteDevice device;
} Filter;

/* The thread beside. */
typedef struct Beside {
    Host *host;
    const Filter *filter;
    atomic_int stop;
    unsigned effects;
    pthread_t thread;
} Beside;

static unsigned compared, wrong, structures;

static void lock_queue(void *user)
{
    pthread_mutex_lock(user);
}

static void unlock_queue(void *user)
{
    pthread_mutex_unlock(user);
}

static void check_effect(const Filter *filter, const char *what, IsophoteStatus status)
{
    char message[512] = "";
    IsophoteText text = {message, sizeof message, 0};

    if (status == ISOPHOTE_OK)
        return;
    filter->vulkans->effect_error(filter->effect, &text);
    fail(what, message);
}

/* Loads the library and makes a graph ready on the renderer's device. */
static Filter open_filter(Host *host, const char *path)
{
    char message[512];
    IsophoteText error = {message, sizeof message, 0};
    const uint32_t enabled = ISOPHOTE_VULKAN_STORAGE_IMAGE_EXTENDED_FORMATS | ISOPHOTE_VULKAN_TIMELINE_SEMAPHORE;
    IsophoteVulkanHost own = {0};
    IsophoteVulkanNeeds needs;
    Filter filter = {0};

    filter.api = load(path, &filter.library);
    filter.vulkans = filter.api->extension("isophote.vulkan/1");
    filter.precisions = filter.api->extension("isophote.precision/1");
    if (filter.vulkans == NULL || filter.precisions == NULL)
        fail(path, "it lacks the extension isophote.vulkan/1 or isophote.precision/1");
    /* An engine asks before it makes its device; this one was made by open_gpu. */
    if (filter.vulkans->needs(VK_API_VERSION_1_2, &error, &needs) != ISOPHOTE_OK)
        fail("needs", message);
    if ((needs.features & ~enabled) != 0 || needs.extension_count != 0)
        fail("needs", "this device was made without all of it");
    own.get_instance_proc_addr = (IsophoteVulkanLoader)vkGetInstanceProcAddr;
    own.instance = host->gpu.instance;
    own.physical_device = host->gpu.adapter;
    own.device = host->gpu.device;
    own.queue = host->gpu.queue;
    own.api_version = VK_API_VERSION_1_2;
    own.queue_family = host->gpu.family;
    own.features = enabled;
    own.timeline = (uint64_t)host->done;
    own.user = &host->queue;
    own.lock_queue = lock_queue;
    own.unlock_queue = unlock_queue;
    if (filter.vulkans->create(&own, &error, &filter.vulkan) != ISOPHOTE_OK)
        fail("create", message);
    if (filter.api->graph_create_single("cartoon", &error, &filter.graph) != ISOPHOTE_OK)
        fail("cartoon", message);
    filter.api->request_init(host->width, host->height, &filter.request);
    filter.request.guides = ISOPHOTE_GUIDE_NORMAL | ISOPHOTE_GUIDE_DEPTH | ISOPHOTE_GUIDE_OBJECT_ID;
    if (filter.vulkans->effect_create(filter.vulkan, filter.graph, &filter.request, &error, &filter.effect) !=
        ISOPHOTE_OK)
        fail("effect_create", message);
    if (filter.api->device_create(NULL, &error, &filter.device) != ISOPHOTE_OK)
        fail("device_create", message);
    return filter;
}

/* All that was submitted has been executed. */
static void close_filter(Filter *filter)
{
    filter->vulkans->effect_destroy(filter->effect);
    if (filter->vulkans->destroy(filter->vulkan) != ISOPHOTE_OK)
        fail("destroy", "the object is not there");
    filter->api->device_destroy(filter->device);
    filter->api->graph_destroy(filter->graph);
    dlclose(filter->library);
}

/* Parameters that change on every frame, and some that change the passes now and then. */
static void update(Host *host, Filter *filter, uint32_t number)
{
    IsophoteChange change;
    int was_resized = filter->request.width != host->width || filter->request.height != host->height;
    int is_other = number % 40 == 0;

    filter->request.width = host->width;
    filter->request.height = host->height;
    filter->request.frame = number;
    check(filter->api, filter->graph, "detail",
          filter->api->graph_set_float(filter->graph, 0, "detail", 0.1 + number % 9 * 0.1));
    if (is_other) {
        check(filter->api, filter->graph, "precision",
              filter->precisions->graph_set_precision(filter->graph, number / 40 % 3));
        check(filter->api, filter->graph, "posterize",
              filter->api->graph_set_int(filter->graph, 0, "posterize", number % 80 == 0 ? 0 : 6));
    }
    check_effect(filter, "effect_update",
                 filter->vulkans->effect_update(filter->effect, filter->graph, &filter->request, &change));
    if (was_resized && change != ISOPHOTE_CHANGE_STRUCTURE)
        fail("effect_update", "it did not notice another size");
    structures += change == ISOPHOTE_CHANGE_STRUCTURE;
    if (change == ISOPHOTE_CHANGE_STRUCTURE && !was_resized && !is_other)
        fail("effect_update", "another value of a slider made other passes");
}

/* How the library sees an image of the renderer's. */
static IsophoteVulkanImage seen(const char *name, const Image *image, VkImageLayout before, VkImageLayout after)
{
    IsophoteVulkanImage seen = {0};

    seen.name = name;
    seen.image = (uint64_t)image->image;
    seen.view = (uint64_t)image->view;
    seen.format = image->format;
    seen.usage = image->usage;
    seen.width = image->width;
    seen.height = image->height;
    seen.layout_before = before;
    seen.layout_after = after;
    return seen;
}

/* The layout in which a result is left: that in which it is written where shaders write it, or one for copies. */
static VkImageLayout left_in(const Image *result)
{
    return result->usage & VK_IMAGE_USAGE_STORAGE_BIT ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
}

static void see(const Frame *frame, IsophoteVulkanImage images[DRAWN + 1])
{
    const VkImageLayout read = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    uint32_t i;

    for (i = 0; i < DRAWN; i++)
        images[i] = seen(NAMES[i], &frame->images[i], read, read);
    images[DRAWN] =
        seen("output", &frame->images[RESULT], VK_IMAGE_LAYOUT_UNDEFINED, left_in(&frame->images[RESULT]));
}

static void wait_for(const Host *host, uint64_t value)
{
    VkSemaphoreWaitInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};

    info.semaphoreCount = 1;
    info.pSemaphores = &host->done;
    info.pValues = &value;
    succeed("vkWaitSemaphores", vkWaitSemaphores(host->gpu.device, &info, UINT64_MAX));
}

static void begin(const Host *host, const Frame *frame)
{
    VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};

    succeed("vkResetCommandPool", vkResetCommandPool(host->gpu.device, frame->pool, 0));
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    succeed("vkBeginCommandBuffer", vkBeginCommandBuffer(frame->commands, &info));
}

/* Submits the frame's commands, which bring a timeline to the host's value. */
static void end(Host *host, const Frame *frame, VkSemaphore timeline)
{
    VkTimelineSemaphoreSubmitInfo values = {.sType = VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO};
    VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};

    succeed("vkEndCommandBuffer", vkEndCommandBuffer(frame->commands));
    values.signalSemaphoreValueCount = 1;
    values.pSignalSemaphoreValues = &host->value;
    submit.pNext = &values;
    submit.commandBufferCount = submit.signalSemaphoreCount = 1;
    submit.pCommandBuffers = &frame->commands;
    submit.pSignalSemaphores = &timeline;
    lock_queue(&host->queue);
    succeed("vkQueueSubmit", vkQueueSubmit(host->gpu.queue, 1, &submit, VK_NULL_HANDLE));
    unlock_queue(&host->queue);
}

/* Records the copy of an image to memory that the CPU sees. */
static void copy_image(const Frame *frame, const Image *image, VkImageLayout layout, const Buffer *to)
{
    VkMemoryBarrier seen = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    VkBufferImageCopy copy = {0};

    copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    copy.imageSubresource.layerCount = copy.imageExtent.depth = 1;
    copy.imageExtent.width = image->width;
    copy.imageExtent.height = image->height;
    vkCmdCopyImageToBuffer(frame->commands, image->image, layout, to->buffer, 1, &copy);
    seen.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    seen.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(frame->commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &seen, 0,
                         NULL, 0, NULL);
}

/* Draws, stylizes and copies a frame in one command buffer: the library has barriers for what is before and after it. */
static void render_recorded(Host *host, const Filter *filter, const Frame *frame, uint32_t number)
{
    IsophoteVulkanImage images[DRAWN + 1];

    see(frame, images);
    begin(host, frame);
    draw(&host->scene, frame, number);
    check_effect(filter, "record",
                 filter->vulkans->record(filter->effect, frame->commands, images, DRAWN + 1, host->value));
    copy_image(frame, &frame->images[RESULT], left_in(&frame->images[RESULT]), &host->copies[number % IN_FLIGHT]);
    end(host, frame, host->done);
}

/* Draws a frame, and lets the library submit the rest. */
static void render_submitted(Host *host, const Filter *filter, const Frame *frame, uint32_t number)
{
    IsophoteVulkanImage images[DRAWN + 1];
    IsophoteVulkanSemaphore drawn = {(uint64_t)host->drawn, host->value};

    see(frame, images);
    begin(host, frame);
    draw(&host->scene, frame, number);
    end(host, frame, host->drawn);
    check_effect(filter, "submit",
                 filter->vulkans->submit(filter->effect, images, DRAWN + 1, &drawn, 1, NULL, 0, host->value));
}

/* A copy of an image, which is in `layout`, in memory that the CPU sees. */
static Buffer read_back(Host *host, const Frame *frame, const Image *image, VkImageLayout layout)
{
    VkImageMemoryBarrier ready = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    VkDeviceSize size = (VkDeviceSize)image->width * image->height * 16;
    Buffer buffer = create_buffer(&host->gpu, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);

    wait_for(host, host->value);
    host->value++;
    begin(host, frame);
    ready.oldLayout = layout;
    ready.newLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    ready.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    ready.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;
    ready.srcQueueFamilyIndex = ready.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    ready.image = image->image;
    ready.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    ready.subresourceRange.levelCount = ready.subresourceRange.layerCount = 1;
    vkCmdPipelineBarrier(frame->commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         NULL, 0, NULL, 1, &ready);
    copy_image(frame, image, ready.newLayout, &buffer);
    end(host, frame, host->done);
    wait_for(host, host->value);
    return buffer;
}

/* What the library's `process` makes of the images of a frame: four floats a pixel. */
static float *expected(Host *host, const Filter *filter, const Frame *frame)
{
    const size_t width = host->width, height = host->height;
    float *pixels = allocate(width * height * 4, sizeof *pixels);
    Buffer buffers[DRAWN];
    IsophoteInput inputs[DRAWN] = {0};
    IsophoteTarget target = {pixels, (ptrdiff_t)width * 16, ISOPHOTE_SAMPLE_F32, 4, host->width, host->height, 0, 0};
    uint32_t i;

    for (i = 0; i < DRAWN; i++) {
        size_t texel = CHANNELS[i] * (SAMPLES[i] == ISOPHOTE_SAMPLE_F16 ? 2 : 4);
        buffers[i] = read_back(host, frame, &frame->images[i], VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
        inputs[i].name = NAMES[i];
        inputs[i].image.data = buffers[i].bytes;
        inputs[i].image.row_stride = (ptrdiff_t)(width * texel);
        inputs[i].image.sample = SAMPLES[i];
        inputs[i].image.channels = CHANNELS[i];
        inputs[i].image.width = host->width;
        inputs[i].image.height = host->height;
    }
    check(filter->api, filter->graph, "process",
          filter->api->process(filter->graph, filter->device, &filter->request, inputs, DRAWN, NULL, &target, NULL,
                               NULL));
    for (i = 0; i < DRAWN; i++)
        destroy_buffer(&host->gpu, &buffers[i]);
    return pixels;
}

/* How far a result may lie from that of `process`, whose shaders another compiler has made: the last bits differ and with
 * them, where colours have half precision, the eleventh, which is a thousandth at most. */
static float allowed(float value)
{
    return 0.001f * (1.0f + fabsf(value));
}

/* Counts the samples that differ from what `process` makes; keeps the picture where there is a place for it. */
static void compare(Host *host, const Filter *filter, const Frame *frame, uint32_t number, unsigned char *picture)
{
    const size_t count = (size_t)host->width * host->height * 4;
    const Image *image = &frame->images[RESULT];
    float *theirs = expected(host, filter, frame);
    Buffer read = read_back(host, frame, image, left_in(image));
    const unsigned char *ours = number % 2 == 0 ? host->copies[number % IN_FLIGHT].bytes : read.bytes;
    size_t i;

    for (i = 0; i < count; i++) {
        float value = theirs[i] < 0.0f ? 0.0f : theirs[i] > 1.0f ? 1.0f : theirs[i];
        /* A result of 8 bits is the nearest of them. */
        if (image->format == VK_FORMAT_R8G8B8A8_UNORM)
            wrong += !(fabsf(ours[i] - value * 255.0f) <= 0.505f + 255.0f * allowed(value));
        else
            wrong += !(fabsf(((const float *)(const void *)ours)[i] - theirs[i]) <= allowed(theirs[i]));
        if (picture != NULL && i % 4 < 3)
            picture[i / 4 * 3 + i % 4] = (unsigned char)(value * 255.0f + 0.5f);
    }
    compared++;
    destroy_buffer(&host->gpu, &read);
    free(theirs);
}

/* Makes the images of all frames in flight: results of 32-bit floats, which are written directly unless colours have half
 * precision, or of 8 bits. */
static void make_frames(Host *host)
{
    VkDeviceSize size = (VkDeviceSize)host->width * host->height * 16;
    uint32_t i;

    for (i = 0; i < IN_FLIGHT; i++) {
        host->copies[i] = create_buffer(&host->gpu, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
        host->frames[i] =
            i % 2 == 0 ? make_frame(&host->gpu, &host->scene, host->width, host->height, VK_FORMAT_R32G32B32A32_SFLOAT,
                                    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                        VK_IMAGE_USAGE_TRANSFER_DST_BIT)
                       : make_frame(&host->gpu, &host->scene, host->width, host->height, VK_FORMAT_R8G8B8A8_UNORM,
                                    VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    }
}

static void destroy_frames(Host *host)
{
    uint32_t i;

    wait_for(host, host->value);
    for (i = 0; i < IN_FLIGHT; i++) {
        destroy_buffer(&host->gpu, &host->copies[i]);
        destroy_frame(&host->gpu, &host->frames[i]);
    }
}

/* Uses the queue and makes effects while frames are rendered. */
static void *work_beside(void *argument)
{
    Beside *beside = argument;
    const struct timespec pause = {0, 5000000};
    const Filter *filter = beside->filter;
    Host *host = beside->host;
    char message[512];
    IsophoteText error = {message, sizeof message, 0};
    IsophoteVulkanEffect effect;
    IsophoteRequest request;
    IsophoteGraph graph;

    if (filter->api->graph_create_single("gaussian", &error, &graph) != ISOPHOTE_OK)
        fail("gaussian", message);
    for (; !atomic_load(&beside->stop); beside->effects++) {
        lock_queue(&host->queue);
        succeed("vkQueueSubmit", vkQueueSubmit(host->gpu.queue, 0, NULL, VK_NULL_HANDLE));
        unlock_queue(&host->queue);
        filter->api->request_init(16 + beside->effects % 16, 16, &request);
        if (filter->vulkans->effect_create(filter->vulkan, graph, &request, &error, &effect) != ISOPHOTE_OK)
            fail("effect_create", message);
        if (filter->vulkans->effect_destroy(effect) != ISOPHOTE_OK)
            fail("effect_destroy", "the effect is not there");
        nanosleep(&pause, NULL);
    }
    filter->api->graph_destroy(graph);
    return NULL;
}

/* Renders frames `first` to `last`; returns how many effects were made beside them. */
static unsigned render(Host *host, const char *path, uint32_t first, uint32_t last, unsigned char *picture)
{
    const uint32_t sizes = sizeof SIZES / sizeof *SIZES;
    Beside beside = {0};
    Filter filter;
    uint32_t number;

    host->width = SIZES[0][0] * host->scale;
    host->height = SIZES[0][1] * host->scale;
    make_frames(host);
    filter = open_filter(host, path);
    beside.host = host;
    beside.filter = &filter;
    if (pthread_create(&beside.thread, NULL, work_beside, &beside) != 0)
        fail("pthread_create", "there is no thread");
    for (number = first; number < last; number++) {
        const Frame *frame = &host->frames[number % IN_FLIGHT];
        const uint32_t *size = SIZES[number / RESIZED % sizes];

        if (host->width != size[0] * host->scale || host->height != size[1] * host->scale) {
            /* The last frames of the old size are still in flight. */
            host->width = size[0] * host->scale;
            host->height = size[1] * host->scale;
            update(host, &filter, number);
            destroy_frames(host);
            make_frames(host);
        } else {
            update(host, &filter, number);
        }
        /* What the frame's images showed before has been stylized. */
        if (host->value >= IN_FLIGHT)
            wait_for(host, host->value - (IN_FLIGHT - 1));
        host->value++;
        (number % 2 == 0 ? render_recorded : render_submitted)(host, &filter, frame, number);
        if (number % COMPARED == 0 || number + 1 == last)
            compare(host, &filter, frame, number, number + 1 == last ? picture : NULL);
    }
    wait_for(host, host->value);
    atomic_store(&beside.stop, 1);
    pthread_join(beside.thread, NULL);
    close_filter(&filter);
    destroy_frames(host);
    return beside.effects;
}

static VkSemaphore make_timeline(const Gpu *gpu)
{
    VkSemaphoreTypeCreateInfo type = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
    VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    VkSemaphore made;

    type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
    succeed("vkCreateSemaphore", vkCreateSemaphore(gpu->device, &info, NULL, &made));
    return made;
}

int main(int argc, char **argv)
{
    VkPhysicalDeviceVulkan12Features features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    Host host = {0};
    Picture picture;
    uint32_t frames, round;
    unsigned beside = 0;

    if (argc < 5 || argc > 6) {
        fprintf(stderr, "usage: vulkan_host LIBRARY SCENE.spv FRAMES SCALE [OUT.ppm]\n");
        return 2;
    }
    frames = (uint32_t)strtoul(argv[3], NULL, 10);
    host.scale = (uint32_t)strtoul(argv[4], NULL, 10);
    features.timelineSemaphore = VK_TRUE;
    host.gpu = open_gpu(VK_API_VERSION_1_2, VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT, &features);
    host.scene = make_scene(&host.gpu, argv[2]);
    host.drawn = make_timeline(&host.gpu);
    host.done = make_timeline(&host.gpu);
    pthread_mutex_init(&host.queue, NULL);
    picture.data = allocate((size_t)host.scale * host.scale * 96 * 64 * 3, 1);
    for (round = 0; round < ROUNDS; round++)
        beside += render(&host, argv[1], frames * round / ROUNDS, frames * (round + 1) / ROUNDS, picture.data);
    picture.width = host.width;
    picture.height = host.height;
    if (argc == 6)
        write_ppm(argv[5], picture);
    printf("%s, %s: %u frames, %u effects beside, %u other structures, %u frames compared, %u samples wrong\n",
           host.gpu.properties.deviceName, host.gpu.messenger != VK_NULL_HANDLE ? "validated" : "not validated", frames,
           beside, structures, compared, wrong);
    free(picture.data);
    pthread_mutex_destroy(&host.queue);
    vkDestroySemaphore(host.gpu.device, host.done, NULL);
    vkDestroySemaphore(host.gpu.device, host.drawn, NULL);
    destroy_scene(&host.gpu, &host.scene);
    close_gpu(&host.gpu);
    return complaints == 0 && wrong == 0 ? 0 : 1;
}
