/* A renderer in Vulkan: octahedra that turn, drawn into a G-buffer of colour, normals, distances and object numbers.
 *
 * Nothing here is about the library, but that its images can be read by shaders; vulkan_host.c stylizes them. */
#ifndef VULKAN_SCENE_H
#define VULKAN_SCENE_H

#include "vulkan_device.h"

enum { COLOR, NORMAL, DISTANCE, OBJECT, DRAWN, Z_BUFFER = DRAWN, RESULT, IMAGES };

/* 5 octahedra of 8 triangles. */
#define CORNERS 120

typedef struct Image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
    VkFormat format;
    VkImageUsageFlags usage;
    uint32_t width, height;
} Image;

typedef struct Scene {
    VkRenderPass pass;
    VkPipelineLayout layout;
    VkPipeline pipeline;
} Scene;

/* What one frame is drawn into, and from which commands. */
typedef struct Frame {
    Image images[IMAGES];
    VkFramebuffer framebuffer;
    VkCommandPool pool;
    VkCommandBuffer commands;
} Frame;

static const VkFormat DRAWN_FORMATS[DRAWN + 1] = {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT,
                                                  VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32_SFLOAT,
                                                  VK_FORMAT_D32_SFLOAT};

static Image make_image(const Gpu *gpu, VkFormat format, VkImageUsageFlags usage, uint32_t width, uint32_t height)
{
    Image made = {0};
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    VkMemoryRequirements needs;

    made.format = info.format = view.format = format;
    made.usage = info.usage = usage;
    made.width = info.extent.width = width;
    made.height = info.extent.height = height;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.extent.depth = info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    succeed("vkCreateImage", vkCreateImage(gpu->device, &info, NULL, &made.image));
    vkGetImageMemoryRequirements(gpu->device, made.image, &needs);
    made.memory = allocate_memory(gpu, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    succeed("vkBindImageMemory", vkBindImageMemory(gpu->device, made.image, made.memory, 0));
    /* Images that are only copied have no views. */
    if ((usage & ~(VkImageUsageFlags)(VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT)) == 0)
        return made;
    view.image = made.image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.subresourceRange.aspectMask =
        format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
    view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
    succeed("vkCreateImageView", vkCreateImageView(gpu->device, &view, NULL, &made.view));
    return made;
}

static void destroy_image(const Gpu *gpu, Image *image)
{
    vkDestroyImageView(gpu->device, image->view, NULL);
    vkDestroyImage(gpu->device, image->image, NULL);
    vkFreeMemory(gpu->device, image->memory, NULL);
}

/* A pass that clears everything and leaves it to be read by shaders. */
static VkRenderPass make_pass(const Gpu *gpu)
{
    VkAttachmentDescription attachments[DRAWN + 1] = {0};
    VkAttachmentReference colors[DRAWN], depth;
    VkSubpassDescription subpass = {0};
    VkSubpassDependency before = {0};
    VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO};
    VkRenderPass pass;
    uint32_t i;

    for (i = 0; i <= DRAWN; i++) {
        attachments[i].format = DRAWN_FORMATS[i];
        attachments[i].samples = VK_SAMPLE_COUNT_1_BIT;
        attachments[i].loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
        attachments[i].storeOp = i < DRAWN ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
        attachments[i].initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
        attachments[i].finalLayout = i < DRAWN ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                                               : VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    }
    for (i = 0; i < DRAWN; i++) {
        colors[i].attachment = i;
        colors[i].layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    }
    depth.attachment = DRAWN;
    depth.layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = DRAWN;
    subpass.pColorAttachments = colors;
    subpass.pDepthStencilAttachment = &depth;
    /* Frames that use the same images wait for each other. */
    before.srcSubpass = VK_SUBPASS_EXTERNAL;
    before.srcStageMask = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
    before.dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT;
    before.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
    before.dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT |
                           VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
    info.attachmentCount = DRAWN + 1;
    info.pAttachments = attachments;
    info.subpassCount = info.dependencyCount = 1;
    info.pSubpasses = &subpass;
    info.pDependencies = &before;
    succeed("vkCreateRenderPass", vkCreateRenderPass(gpu->device, &info, NULL, &pass));
    return pass;
}

/* The shaders, from a file of SPIR-V. */
static VkShaderModule read_shaders(const Gpu *gpu, const char *path)
{
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    VkShaderModule module;
    FILE *file = fopen(path, "rb");
    long size = 0;
    uint32_t *words;

    if (file == NULL || fseek(file, 0, SEEK_END) != 0 || (size = ftell(file)) <= 0 || size % 4 != 0)
        fail(path, "is no file of SPIR-V");
    rewind(file);
    words = allocate((size_t)size, 1);
    if (fread(words, 1, (size_t)size, file) != (size_t)size)
        fail(path, "ends early");
    fclose(file);
    info.codeSize = (size_t)size;
    info.pCode = words;
    succeed("vkCreateShaderModule", vkCreateShaderModule(gpu->device, &info, NULL, &module));
    free(words);
    return module;
}

static void make_pipeline(const Gpu *gpu, Scene *scene, VkShaderModule shaders)
{
    VkPipelineShaderStageCreateInfo stages[2] = {{.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO},
                                                 {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO}};
    VkPipelineVertexInputStateCreateInfo vertices = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    VkPipelineViewportStateCreateInfo viewport = {.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    VkPipelineMultisampleStateCreateInfo samples = {.sType =
                                                        VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    VkPipelineDepthStencilStateCreateInfo depth = {.sType =
                                                       VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    VkPipelineColorBlendAttachmentState writes[DRAWN] = {0};
    VkPipelineColorBlendStateCreateInfo blend = {.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    VkDynamicState states[2] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic = {.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    VkGraphicsPipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    uint32_t i;

    stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
    stages[0].pName = "corner";
    stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[1].pName = "pixel";
    stages[0].module = stages[1].module = shaders;
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    viewport.viewportCount = viewport.scissorCount = 1;
    raster.lineWidth = 1.0f;
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS;
    for (i = 0; i < DRAWN; i++)
        writes[i].colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT |
                                   VK_COLOR_COMPONENT_A_BIT;
    blend.attachmentCount = DRAWN;
    blend.pAttachments = writes;
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = states;
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &vertices;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = scene->layout;
    info.renderPass = scene->pass;
    succeed("vkCreateGraphicsPipelines", vkCreateGraphicsPipelines(gpu->device, VK_NULL_HANDLE, 1, &info, NULL,
                                                                   &scene->pipeline));
}

static Scene make_scene(const Gpu *gpu, const char *shader_path)
{
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    VkShaderModule shaders = read_shaders(gpu, shader_path);
    Scene scene;

    scene.pass = make_pass(gpu);
    succeed("vkCreatePipelineLayout", vkCreatePipelineLayout(gpu->device, &layout, NULL, &scene.layout));
    make_pipeline(gpu, &scene, shaders);
    vkDestroyShaderModule(gpu->device, shaders, NULL);
    return scene;
}

static void destroy_scene(const Gpu *gpu, Scene *scene)
{
    vkDestroyPipeline(gpu->device, scene->pipeline, NULL);
    vkDestroyPipelineLayout(gpu->device, scene->layout, NULL);
    vkDestroyRenderPass(gpu->device, scene->pass, NULL);
}

/* The images of a frame; results have the format and usage given. */
static Frame make_frame(const Gpu *gpu, const Scene *scene, uint32_t width, uint32_t height, VkFormat result,
                        VkImageUsageFlags usage)
{
    VkFramebufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    VkImageView views[DRAWN + 1];
    Frame frame;
    uint32_t i;

    for (i = 0; i <= DRAWN; i++) {
        VkImageUsageFlags drawn =
            i == Z_BUFFER ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                          : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        frame.images[i] = make_image(gpu, DRAWN_FORMATS[i], drawn, width, height);
        views[i] = frame.images[i].view;
    }
    frame.images[RESULT] = make_image(gpu, result, usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, width, height);
    info.renderPass = scene->pass;
    info.attachmentCount = DRAWN + 1;
    info.pAttachments = views;
    info.width = width;
    info.height = height;
    info.layers = 1;
    succeed("vkCreateFramebuffer", vkCreateFramebuffer(gpu->device, &info, NULL, &frame.framebuffer));
    pool.queueFamilyIndex = gpu->family;
    succeed("vkCreateCommandPool", vkCreateCommandPool(gpu->device, &pool, NULL, &frame.pool));
    commands.commandPool = frame.pool;
    commands.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    commands.commandBufferCount = 1;
    succeed("vkAllocateCommandBuffers", vkAllocateCommandBuffers(gpu->device, &commands, &frame.commands));
    return frame;
}

static void destroy_frame(const Gpu *gpu, Frame *frame)
{
    uint32_t i;

    vkDestroyCommandPool(gpu->device, frame->pool, NULL);
    vkDestroyFramebuffer(gpu->device, frame->framebuffer, NULL);
    for (i = 0; i < IMAGES; i++)
        destroy_image(gpu, &frame->images[i]);
}

/* Draws the scene as it is in a frame. */
static void draw(const Scene *scene, const Frame *frame, uint32_t number)
{
    VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    VkClearValue clear[DRAWN + 1] = {{.color = {.float32 = {0.7f, 0.8f, 0.9f, 1.0f}}}};
    VkViewport viewport = {.maxDepth = 1.0f};
    uint32_t width = frame->images[COLOR].width, height = frame->images[COLOR].height;

    clear[Z_BUFFER].depthStencil.depth = 1.0f;
    begin.renderPass = scene->pass;
    begin.framebuffer = frame->framebuffer;
    begin.renderArea.extent.width = width;
    begin.renderArea.extent.height = height;
    begin.clearValueCount = DRAWN + 1;
    begin.pClearValues = clear;
    viewport.width = (float)width;
    viewport.height = (float)height;
    vkCmdBeginRenderPass(frame->commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    vkCmdBindPipeline(frame->commands, VK_PIPELINE_BIND_POINT_GRAPHICS, scene->pipeline);
    vkCmdSetViewport(frame->commands, 0, 1, &viewport);
    vkCmdSetScissor(frame->commands, 0, 1, &begin.renderArea);
    /* The shaders know the frame by the number of the first instance. */
    vkCmdDraw(frame->commands, CORNERS, 1, 0, number);
    vkCmdEndRenderPass(frame->commands);
}

#endif
