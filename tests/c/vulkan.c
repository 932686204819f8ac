/* Runs a plan of the library with Vulkan, on a device of this program's own: an example to copy.
 *
 * vulkan LIBRARY IN.ppm OUT.ppm NODE [param=value ...]
 *
 * The library says what is to be computed: images, passes, uniform bytes, SPIR-V. This program makes the
 * Vulkan objects once (make_images, make_uniforms, make_passes), fills the uniforms (write_uniforms) and
 * records the passes with the barriers between them (record). A viewer does the last on every frame, and
 * write_uniforms after a plan_update that gave ISOPHOTE_CHANGE_UNIFORMS.
 */
#include "ppm.h"
#include "vulkan_device.h"

static const VkFormat FORMATS[] = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT,
                                   VK_FORMAT_R32G32B32A32_SFLOAT};
static const uint32_t CHANNELS[] = {1, 2, 4};
static const VkDescriptorType DESCRIPTORS[] = {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                               VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
                                               VK_DESCRIPTOR_TYPE_STORAGE_IMAGE};

/* Most bindings of a kernel that this program provides for. */
#define MOST_BINDINGS 16

typedef struct Image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
} Image;

/* What passes of the same kernel share. */
typedef struct Kernel {
    const char *name;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline;
} Kernel;

typedef struct Pass {
    const Kernel *kernel;
    VkDescriptorSet set;
    VkDeviceSize grid_at, params_at; /* in the uniform buffer */
} Pass;

/* A plan with everything that Vulkan needs to run it. */
typedef struct Runner {
    const IsophoteApi *api;
    IsophotePlan plan;
    const IsophoteTexture *textures;
    const IsophotePass *steps;
    uint32_t texture_count, pass_count, kernel_count;
    Image *images;   /* by the plan's indices of textures */
    Pass *passes;    /* by the plan's indices of passes */
    Kernel *kernels; /* each kernel of the plan once */
    Buffer uniforms;
    VkDescriptorPool pool;
} Runner;

static void check_plan(const Runner *runner, const char *what, IsophoteStatus status)
{
    char message[512] = "";
    IsophoteText text = {message, sizeof message, 0};

    if (status == ISOPHOTE_OK)
        return;
    runner->api->plan_error(runner->plan, &text);
    fail(what, message);
}

/* An image for every texture of the plan. An engine does not make the inputs: it binds images of its own. */
static void make_images(const Gpu *gpu, Runner *runner)
{
    uint32_t i;

    runner->images = allocate(runner->texture_count, sizeof *runner->images);
    for (i = 0; i < runner->texture_count; i++) {
        const IsophoteTexture *texture = &runner->textures[i];
        Image *made = &runner->images[i];
        VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
        VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
        VkMemoryRequirements needs;

        info.imageType = VK_IMAGE_TYPE_2D;
        info.format = FORMATS[texture->format];
        info.extent.width = texture->width;
        info.extent.height = texture->height;
        info.extent.depth = info.mipLevels = info.arrayLayers = 1;
        info.samples = VK_SAMPLE_COUNT_1_BIT;
        info.usage = VK_IMAGE_USAGE_SAMPLED_BIT;
        if (texture->role == ISOPHOTE_ROLE_INPUT)
            info.usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        else
            info.usage |= VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        succeed("vkCreateImage", vkCreateImage(gpu->device, &info, NULL, &made->image));
        vkGetImageMemoryRequirements(gpu->device, made->image, &needs);
        made->memory = allocate_memory(gpu, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
        succeed("vkBindImageMemory", vkBindImageMemory(gpu->device, made->image, made->memory, 0));
        view.image = made->image;
        view.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view.format = info.format;
        view.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
        view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
        succeed("vkCreateImageView", vkCreateImageView(gpu->device, &view, NULL, &made->view));
    }
}

/* A block's size in the buffer: shaders round it up to 16 bytes. */
static VkDeviceSize block_size(uint32_t bytes)
{
    return (bytes + 15u) / 16u * 16u;
}

/* One buffer for the uniform blocks of all passes. */
static void make_uniforms(const Gpu *gpu, Runner *runner)
{
    VkDeviceSize alignment = gpu->properties.limits.minUniformBufferOffsetAlignment, end = 0;
    uint32_t i;

    runner->passes = allocate(runner->pass_count, sizeof *runner->passes);
    for (i = 0; i < runner->pass_count; i++) {
        runner->passes[i].grid_at = end;
        end += (block_size(runner->steps[i].grid_size) + alignment - 1) / alignment * alignment;
        /* Kernels without parameters have no block for them. */
        runner->passes[i].params_at = end;
        end += (block_size(runner->steps[i].params_size) + alignment - 1) / alignment * alignment;
    }
    runner->uniforms = create_buffer(gpu, end, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
}

/* Copies the bytes that the plan has now; the GPU must not be reading the old ones. */
static void write_uniforms(Runner *runner)
{
    uint32_t i;

    for (i = 0; i < runner->pass_count; i++) {
        const IsophotePass *step = &runner->steps[i];
        memcpy(runner->uniforms.bytes + runner->passes[i].grid_at, step->grid, step->grid_size);
        if (step->params_size > 0)
            memcpy(runner->uniforms.bytes + runner->passes[i].params_at, step->params, step->params_size);
    }
}

/* Compiles the kernel of a pass. */
static void make_kernel(const Gpu *gpu, const IsophoteShader *shader, Kernel *made)
{
    VkDescriptorSetLayoutBinding bindings[MOST_BINDINGS] = {0};
    VkDescriptorSetLayoutCreateInfo set_info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    VkPipelineLayoutCreateInfo layout_info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    VkShaderModuleCreateInfo module_info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    VkShaderModule module;
    uint32_t i;

    if (shader->binding_count > MOST_BINDINGS)
        fail(made->name, "has too many bindings");
    for (i = 0; i < shader->binding_count; i++) {
        bindings[i].binding = shader->bindings[i].slot;
        bindings[i].descriptorType = DESCRIPTORS[shader->bindings[i].kind];
        bindings[i].descriptorCount = 1;
        bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    set_info.bindingCount = shader->binding_count;
    set_info.pBindings = bindings;
    succeed("vkCreateDescriptorSetLayout",
            vkCreateDescriptorSetLayout(gpu->device, &set_info, NULL, &made->set_layout));
    layout_info.setLayoutCount = 1;
    layout_info.pSetLayouts = &made->set_layout;
    succeed("vkCreatePipelineLayout", vkCreatePipelineLayout(gpu->device, &layout_info, NULL, &made->layout));
    module_info.codeSize = shader->size;
    module_info.pCode = shader->code;
    succeed("vkCreateShaderModule", vkCreateShaderModule(gpu->device, &module_info, NULL, &module));
    info.layout = made->layout;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module;
    info.stage.pName = shader->entry_point;
    succeed("vkCreateComputePipelines", vkCreateComputePipelines(gpu->device, VK_NULL_HANDLE, 1, &info, NULL,
                                                                 &made->pipeline));
    vkDestroyShaderModule(gpu->device, module, NULL);
}

/* The kernel of pass `pass`, compiled when it is first met. */
static const Kernel *find_kernel(const Gpu *gpu, Runner *runner, uint32_t pass, const IsophoteShader *shader)
{
    Kernel *made = &runner->kernels[runner->kernel_count];
    uint32_t i;

    for (i = 0; i < runner->kernel_count; i++)
        if (strcmp(runner->kernels[i].name, runner->steps[pass].kernel) == 0)
            return &runner->kernels[i];
    made->name = runner->steps[pass].kernel;
    make_kernel(gpu, shader, made);
    runner->kernel_count++;
    return made;
}

/* Says what lies at each binding of a pass: 0 the grid, 1 the parameters, then the images read and written. */
static void write_set(const Gpu *gpu, const Runner *runner, uint32_t pass, const IsophoteShader *shader)
{
    const IsophotePass *step = &runner->steps[pass];
    VkWriteDescriptorSet writes[MOST_BINDINGS] = {0};
    VkDescriptorBufferInfo buffers[MOST_BINDINGS] = {0};
    VkDescriptorImageInfo images[MOST_BINDINGS] = {0};
    uint32_t i;

    for (i = 0; i < shader->binding_count; i++) {
        uint32_t binding = shader->bindings[i].binding;
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = runner->passes[pass].set;
        writes[i].dstBinding = shader->bindings[i].slot;
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = DESCRIPTORS[shader->bindings[i].kind];
        if (shader->bindings[i].kind == ISOPHOTE_BINDING_UNIFORM) {
            buffers[i].buffer = runner->uniforms.buffer;
            buffers[i].offset = binding == 0 ? runner->passes[pass].grid_at : runner->passes[pass].params_at;
            buffers[i].range = block_size(binding == 0 ? step->grid_size : step->params_size);
            writes[i].pBufferInfo = &buffers[i];
        } else {
            uint32_t texture = binding - 2 < step->input_count ? step->inputs[binding - 2]
                                                               : step->outputs[binding - 2 - step->input_count];
            images[i].imageView = runner->images[texture].view;
            images[i].imageLayout = VK_IMAGE_LAYOUT_GENERAL;
            writes[i].pImageInfo = &images[i];
        }
    }
    vkUpdateDescriptorSets(gpu->device, shader->binding_count, writes, 0, NULL);
}

/* A pipeline for every kernel and a descriptor set for every pass. */
static void make_passes(const Gpu *gpu, Runner *runner)
{
    VkDescriptorPoolSize sizes[3];
    VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    uint32_t i;

    for (i = 0; i < 3; i++) {
        sizes[i].type = DESCRIPTORS[i];
        sizes[i].descriptorCount = runner->pass_count * MOST_BINDINGS;
    }
    pool.maxSets = runner->pass_count;
    pool.poolSizeCount = 3;
    pool.pPoolSizes = sizes;
    succeed("vkCreateDescriptorPool", vkCreateDescriptorPool(gpu->device, &pool, NULL, &runner->pool));
    runner->kernels = allocate(runner->pass_count, sizeof *runner->kernels);
    for (i = 0; i < runner->pass_count; i++) {
        VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
        const IsophoteShader *shader;

        check_plan(runner, "plan_shader",
                   runner->api->plan_shader(runner->plan, i, ISOPHOTE_LANGUAGE_SPIRV, &shader));
        runner->passes[i].kernel = find_kernel(gpu, runner, i, shader);
        info.descriptorPool = runner->pool;
        info.descriptorSetCount = 1;
        info.pSetLayouts = &runner->passes[i].kernel->set_layout;
        succeed("vkAllocateDescriptorSets",
                vkAllocateDescriptorSets(gpu->device, &info, &runner->passes[i].set));
        write_set(gpu, runner, i, shader);
    }
}

/* Makes what `from` has written visible to `to`. */
static void barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags written,
                    VkPipelineStageFlags to, VkAccessFlags used)
{
    VkMemoryBarrier memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER};

    memory.srcAccessMask = written;
    memory.dstAccessMask = used;
    vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, NULL, 0, NULL);
}

/* Gives all images the one layout that everything here can be done in; what they hold is lost. */
static void prepare_images(VkCommandBuffer commands, const Runner *runner)
{
    uint32_t i;

    for (i = 0; i < runner->texture_count; i++) {
        VkImageMemoryBarrier image = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};

        image.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
        image.newLayout = VK_IMAGE_LAYOUT_GENERAL;
        image.srcQueueFamilyIndex = image.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        image.image = runner->images[i].image;
        image.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
        image.subresourceRange.levelCount = image.subresourceRange.layerCount = 1;
        image.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_WRITE_BIT;
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                             VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, NULL,
                             0, NULL, 1, &image);
    }
}

/* Records the passes. A barrier stands before each: most read what the one before has written, and the plan
 * uses its images again as soon as it can. */
static void record(VkCommandBuffer commands, const Runner *runner)
{
    uint32_t i;

    for (i = 0; i < runner->pass_count; i++) {
        const Pass *pass = &runner->passes[i];
        const uint32_t *workgroups = runner->steps[i].workgroups;

        if (i > 0)
            barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                    VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass->kernel->pipeline);
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass->kernel->layout, 0, 1,
                                &pass->set, 0, NULL);
        vkCmdDispatch(commands, workgroups[0], workgroups[1], workgroups[2]);
    }
}

static VkBufferImageCopy whole(const IsophoteTexture *texture)
{
    VkBufferImageCopy copy = {0};

    copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    copy.imageSubresource.layerCount = 1;
    copy.imageExtent.width = texture->width;
    copy.imageExtent.height = texture->height;
    copy.imageExtent.depth = 1;
    return copy;
}

/* Submits one frame, from the pixels in `from` to those in `to`, and waits for it. */
static void run(const Gpu *gpu, const Runner *runner, uint32_t input, const Buffer *from, uint32_t output,
                const Buffer *to)
{
    VkCommandPoolCreateInfo pool_info = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandBufferAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkSubmitInfo submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO};
    VkBufferImageCopy in = whole(&runner->textures[input]), out = whole(&runner->textures[output]);
    VkCommandPool pool;
    VkCommandBuffer commands;

    pool_info.queueFamilyIndex = gpu->family;
    succeed("vkCreateCommandPool", vkCreateCommandPool(gpu->device, &pool_info, NULL, &pool));
    info.commandPool = pool;
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    succeed("vkAllocateCommandBuffers", vkAllocateCommandBuffers(gpu->device, &info, &commands));
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    succeed("vkBeginCommandBuffer", vkBeginCommandBuffer(commands, &begin));
    prepare_images(commands, runner);
    vkCmdCopyBufferToImage(commands, from->buffer, runner->images[input].image, VK_IMAGE_LAYOUT_GENERAL, 1,
                           &in);
    barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
    record(commands, runner);
    barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
            VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    vkCmdCopyImageToBuffer(commands, runner->images[output].image, VK_IMAGE_LAYOUT_GENERAL, to->buffer, 1,
                           &out);
    barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
            VK_ACCESS_HOST_READ_BIT);
    succeed("vkEndCommandBuffer", vkEndCommandBuffer(commands));
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    succeed("vkQueueSubmit", vkQueueSubmit(gpu->queue, 1, &submit, VK_NULL_HANDLE));
    succeed("vkQueueWaitIdle", vkQueueWaitIdle(gpu->queue));
    vkDestroyCommandPool(gpu->device, pool, NULL);
}

static void destroy(const Gpu *gpu, Runner *runner)
{
    uint32_t i;

    for (i = 0; i < runner->kernel_count; i++) {
        vkDestroyPipeline(gpu->device, runner->kernels[i].pipeline, NULL);
        vkDestroyPipelineLayout(gpu->device, runner->kernels[i].layout, NULL);
        vkDestroyDescriptorSetLayout(gpu->device, runner->kernels[i].set_layout, NULL);
    }
    for (i = 0; i < runner->texture_count; i++) {
        vkDestroyImageView(gpu->device, runner->images[i].view, NULL);
        vkDestroyImage(gpu->device, runner->images[i].image, NULL);
        vkFreeMemory(gpu->device, runner->images[i].memory, NULL);
    }
    vkDestroyDescriptorPool(gpu->device, runner->pool, NULL);
    destroy_buffer(gpu, &runner->uniforms);
    free(runner->kernels);
    free(runner->passes);
    free(runner->images);
    runner->api->plan_destroy(runner->plan);
}

/* The plan of a node for a picture: sRGB-encoded colour in and out. */
static Runner make_runner(const Gpu *gpu, const IsophoteApi *api, IsophoteGraph graph, Picture picture)
{
    char message[512];
    IsophoteText error = {message, sizeof message, 0};
    IsophoteRequest request;
    Runner runner = {0};

    runner.api = api;
    api->request_init(picture.width, picture.height, &request);
    if (api->plan_create(graph, &request, NULL, &error, &runner.plan) != ISOPHOTE_OK)
        fail("plan_create", message);
    check_plan(&runner, "plan_textures",
               api->plan_textures(runner.plan, &runner.textures, &runner.texture_count));
    check_plan(&runner, "plan_passes", api->plan_passes(runner.plan, &runner.steps, &runner.pass_count));
    make_images(gpu, &runner);
    make_uniforms(gpu, &runner);
    write_uniforms(&runner);
    make_passes(gpu, &runner);
    return runner;
}

/* Index of the only texture of a role. */
static uint32_t only(const Runner *runner, IsophoteRole role, const char *what)
{
    uint32_t i, found = runner->texture_count;

    for (i = 0; i < runner->texture_count; i++) {
        if (runner->textures[i].role != role)
            continue;
        if (found != runner->texture_count)
            fail(what, "there are several");
        found = i;
    }
    if (found == runner->texture_count)
        fail(what, "there is none");
    return found;
}

/* Stylizes the picture in place. */
static void stylize(const Gpu *gpu, const Runner *runner, Picture picture)
{
    uint32_t input = only(runner, ISOPHOTE_ROLE_INPUT, "inputs");
    uint32_t output = only(runner, ISOPHOTE_ROLE_OUTPUT, "outputs");
    uint32_t channels = CHANNELS[runner->textures[output].format];
    size_t count = (size_t)picture.width * picture.height, i, c;
    Buffer from = create_buffer(gpu, count * 16, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    Buffer to = create_buffer(gpu, count * channels * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    float *pixels = (float *)from.bytes;
    const float *results = (const float *)to.bytes;

    for (i = 0; i < count; i++) {
        for (c = 0; c < 3; c++)
            pixels[i * 4 + c] = picture.data[i * 3 + c] / 255.0f;
        pixels[i * 4 + 3] = 1.0f;
    }
    run(gpu, runner, input, &from, output, &to);
    for (i = 0; i < count; i++)
        for (c = 0; c < 3; c++) {
            float value = results[i * channels + (channels == 1 ? 0 : c)];
            value = value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
            picture.data[i * 3 + c] = (unsigned char)(value * 255.0f + 0.5f);
        }
    destroy_buffer(gpu, &from);
    destroy_buffer(gpu, &to);
}

int main(int argc, char **argv)
{
    void *library;
    const IsophoteApi *api;
    IsophoteGraph graph;
    Picture picture;
    Gpu gpu;
    Runner runner;

    if (argc < 5) {
        fprintf(stderr, "usage: vulkan LIBRARY IN.ppm OUT.ppm NODE [param=value ...]\n");
        return 2;
    }
    api = load(argv[1], &library);
    picture = read_ppm(argv[2]);
    graph = build(api, argv[4], argv + 5, argc - 5);
    gpu = open_gpu(VK_API_VERSION_1_0, VK_QUEUE_COMPUTE_BIT, NULL);
    runner = make_runner(&gpu, api, graph, picture);
    stylize(&gpu, &runner, picture);
    write_ppm(argv[3], picture);
    printf("%s, %s: %u passes of %u kernels on %u images\n", gpu.properties.deviceName,
           gpu.messenger != VK_NULL_HANDLE ? "validated" : "not validated", runner.pass_count,
           runner.kernel_count, runner.texture_count);

    destroy(&gpu, &runner);
    close_gpu(&gpu);
    api->graph_destroy(graph);
    free(picture.data);
    dlclose(library);
    return complaints == 0 ? 0 : 1;
}
