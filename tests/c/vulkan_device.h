/* A Vulkan device with a queue, and its memory: what every engine has already.
 *
 * Nothing here is about the library; vulkan.c shows how to run its plans, vulkan_host.c how to let it record them. Errors
 * end the program. */
#ifndef VULKAN_DEVICE_H
#define VULKAN_DEVICE_H

#include "load.h"

#include <vulkan/vulkan.h>

typedef struct Gpu {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger; /* null without validation layers */
    VkPhysicalDevice adapter;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
} Gpu;

typedef struct Buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    unsigned char *bytes; /* mapped as long as the buffer lives */
} Buffer;

/* Messages of the validation layers so far. */
static unsigned complaints;

static void succeed(const char *what, VkResult result)
{
    char why[64];

    if (result == VK_SUCCESS)
        return;
    snprintf(why, sizeof why, "Vulkan answers %d", (int)result);
    fail(what, why);
}

static void *allocate(size_t count, size_t size)
{
    void *memory = calloc(count ? count : 1, size);

    if (memory == NULL)
        fail("memory", "there is no more");
    return memory;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL complain(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                               VkDebugUtilsMessageTypeFlagsEXT types,
                                               const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity;
    (void)types;
    (void)user;
    fprintf(stderr, "validation: %s\n", data->pMessage);
    complaints++;
    return VK_FALSE;
}

/* Whether the Khronos validation layer is installed. */
static int has_validation(const char *layer)
{
    uint32_t count = 0, i;
    int found = 0;
    VkLayerProperties *layers;

    vkEnumerateInstanceLayerProperties(&count, NULL);
    layers = allocate(count, sizeof *layers);
    succeed("vkEnumerateInstanceLayerProperties", vkEnumerateInstanceLayerProperties(&count, layers));
    for (i = 0; i < count; i++)
        found |= strcmp(layers[i].layerName, layer) == 0;
    free(layers);
    return found;
}

static void create_instance(Gpu *gpu, uint32_t version)
{
    const char *layer = "VK_LAYER_KHRONOS_validation", *extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO};
    VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    int validated = has_validation(layer);

    application.pApplicationName = "isophote example";
    application.apiVersion = version;
    info.pApplicationInfo = &application;
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = complain;
    if (validated) {
        info.enabledLayerCount = info.enabledExtensionCount = 1;
        info.ppEnabledLayerNames = &layer;
        info.ppEnabledExtensionNames = &extension;
        info.pNext = &messenger;
    }
    succeed("vkCreateInstance", vkCreateInstance(&info, NULL, &gpu->instance));
    gpu->messenger = VK_NULL_HANDLE;
    if (validated) {
        PFN_vkCreateDebugUtilsMessengerEXT create = (PFN_vkCreateDebugUtilsMessengerEXT)
            vkGetInstanceProcAddr(gpu->instance, "vkCreateDebugUtilsMessengerEXT");
        succeed("vkCreateDebugUtilsMessengerEXT",
                create(gpu->instance, &messenger, NULL, &gpu->messenger));
    }
}

/* The first adapter that has a queue for all of `wanted`. */
static void choose_adapter(Gpu *gpu, VkQueueFlags wanted)
{
    VkPhysicalDevice adapters[16];
    VkQueueFamilyProperties families[16];
    uint32_t adapter_count = 16, family_count, i, j;
    VkResult result = vkEnumeratePhysicalDevices(gpu->instance, &adapter_count, adapters);

    if (result != VK_INCOMPLETE)
        succeed("vkEnumeratePhysicalDevices", result);
    for (i = 0; i < adapter_count; i++) {
        family_count = 16;
        vkGetPhysicalDeviceQueueFamilyProperties(adapters[i], &family_count, families);
        for (j = 0; j < family_count; j++) {
            if ((families[j].queueFlags & wanted) != wanted)
                continue;
            gpu->adapter = adapters[i];
            gpu->family = j;
            vkGetPhysicalDeviceProperties(gpu->adapter, &gpu->properties);
            vkGetPhysicalDeviceMemoryProperties(gpu->adapter, &gpu->memory);
            return;
        }
    }
    fail("Vulkan", "no adapter has a queue of the kind needed");
}

/* A device of a version with a queue for all of `wanted`; `features_chain` has those of extensions and later versions. */
static Gpu open_gpu(uint32_t version, VkQueueFlags wanted, const void *features_chain)
{
    Gpu gpu;
    float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    VkPhysicalDeviceFeatures features = {0};

    create_instance(&gpu, version);
    choose_adapter(&gpu, wanted);
    info.pNext = features_chain;
    queue.queueFamilyIndex = gpu.family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    /* Images of two floats may be written by shaders only with this. */
    features.shaderStorageImageExtendedFormats = VK_TRUE;
    info.pEnabledFeatures = &features;
    succeed("vkCreateDevice", vkCreateDevice(gpu.adapter, &info, NULL, &gpu.device));
    vkGetDeviceQueue(gpu.device, gpu.family, 0, &gpu.queue);
    return gpu;
}

static void close_gpu(Gpu *gpu)
{
    vkDestroyDevice(gpu->device, NULL);
    if (gpu->messenger != VK_NULL_HANDLE) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy = (PFN_vkDestroyDebugUtilsMessengerEXT)
            vkGetInstanceProcAddr(gpu->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(gpu->instance, gpu->messenger, NULL);
    }
    vkDestroyInstance(gpu->instance, NULL);
}

/* Memory of a kind that `needs` allows and that has all of `wanted`; an engine has an allocator for this. */
static VkDeviceMemory allocate_memory(const Gpu *gpu, VkMemoryRequirements needs, VkMemoryPropertyFlags wanted)
{
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    VkDeviceMemory memory;
    uint32_t i;

    info.allocationSize = needs.size;
    for (i = 0; i < gpu->memory.memoryTypeCount; i++) {
        VkMemoryPropertyFlags has = gpu->memory.memoryTypes[i].propertyFlags;
        if (!(needs.memoryTypeBits >> i & 1) || (has & wanted) != wanted)
            continue;
        info.memoryTypeIndex = i;
        succeed("vkAllocateMemory", vkAllocateMemory(gpu->device, &info, NULL, &memory));
        return memory;
    }
    fail("vkAllocateMemory", "there is no memory of the kind needed");
    return VK_NULL_HANDLE;
}

/* A buffer that the CPU sees. */
static Buffer create_buffer(const Gpu *gpu, VkDeviceSize size, VkBufferUsageFlags usage)
{
    Buffer made;
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    VkMemoryRequirements needs;
    void *bytes;

    info.size = size;
    info.usage = usage;
    succeed("vkCreateBuffer", vkCreateBuffer(gpu->device, &info, NULL, &made.buffer));
    vkGetBufferMemoryRequirements(gpu->device, made.buffer, &needs);
    made.memory = allocate_memory(gpu, needs,
                                  VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    succeed("vkBindBufferMemory", vkBindBufferMemory(gpu->device, made.buffer, made.memory, 0));
    succeed("vkMapMemory", vkMapMemory(gpu->device, made.memory, 0, VK_WHOLE_SIZE, 0, &bytes));
    made.bytes = bytes;
    return made;
}

static void destroy_buffer(const Gpu *gpu, Buffer *buffer)
{
    vkDestroyBuffer(gpu->device, buffer->buffer, NULL);
    vkFreeMemory(gpu->device, buffer->memory, NULL);
}

#endif
