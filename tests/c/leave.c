/* Ends without destroying anything: worker threads wait, a graph, a plan and a device are alive.
 *
 * leave LIBRARY stay|unload cpu|gpu
 *
 * Prints "device" when it had one.
 */
#include "load.h"

int main(int argc, char **argv)
{
    static float pixels[64 * 48 * 4];
    char message[512];
    IsophoteText error = {message, sizeof message, 0};
    void *library;
    const IsophoteApi *api;
    IsophoteRequest request;
    IsophoteInput input = {0};
    IsophoteTarget target = {0};
    IsophoteGraph graph;
    IsophotePlan plan;
    const IsophoteDevice cpu = {0};
    IsophoteDevice device;

    if (argc != 4) {
        fprintf(stderr, "usage: leave LIBRARY stay|unload cpu|gpu\n");
        return 2;
    }
    api = load(argv[1], &library);
    graph = build(api, "gaussian", NULL, 0);
    target.data = pixels;
    target.row_stride = 64 * 4 * sizeof(float);
    target.sample = ISOPHOTE_SAMPLE_F32;
    target.channels = 4;
    target.width = 64;
    target.height = 48;
    input.name = "color";
    input.image.data = pixels;
    input.image.row_stride = target.row_stride;
    input.image.sample = target.sample;
    input.image.channels = target.channels;
    input.image.width = target.width;
    input.image.height = target.height;
    api->request_init(64, 48, &request);
    check(api, graph, "process",
          api->process(graph, cpu, &request, &input, 1, NULL, &target, NULL, NULL));
    if (api->plan_create(graph, &request, NULL, &error, &plan) != ISOPHOTE_OK)
        fail("plan_create", message);
    if (strcmp(argv[3], "gpu") == 0 && api->device_create(NULL, &error, &device) == ISOPHOTE_OK) {
        check(api, graph, "process",
              api->process(graph, device, &request, &input, 1, NULL, &target, NULL, NULL));
        printf("device\n");
    }
    if (strcmp(argv[2], "unload") == 0)
        dlclose(library);
    return 0;
}
