/* Lists the nodes, builds a graph by ids, and stylizes a PPM.
 *
 * stylize LIBRARY IN.ppm OUT.ppm NODE [param=value ...]
 */
#include "ppm.h"

static void progress(void *user, float done)
{
    *(float *)user = done;
}

int main(int argc, char **argv)
{
    void *library;
    const IsophoteApi *api;
    IsophoteCatalogue catalogue;
    IsophoteRequest request;
    IsophoteControl control = {0};
    IsophoteReport report;
    IsophoteInput input = {0};
    IsophoteTarget target = {0};
    IsophoteGraph graph;
    const IsophoteDevice cpu = {0};
    Picture picture;
    float done = 0.0f;
    uint32_t i, j;

    if (argc < 5) {
        fprintf(stderr, "usage: stylize LIBRARY IN.ppm OUT.ppm NODE [param=value ...]\n");
        return 2;
    }
    api = load(argv[1], &library);
    printf("Isophote %s\n", api->version);
    if (api->catalogue(&catalogue) != ISOPHOTE_OK)
        fail("catalogue", "not given");
    for (i = 0; i < catalogue.node_count; i++) {
        const IsophoteNode *node = &catalogue.nodes[i];
        printf("%s (%s):", node->id, node->group);
        for (j = 0; j < node->param_count; j++)
            printf(" %s", node->params[j].id);
        printf("\n");
    }

    picture = read_ppm(argv[2]);
    graph = build(api, argv[4], argv + 5, argc - 5);

    /* The picture is stylized in place. */
    target.data = picture.data;
    target.row_stride = (ptrdiff_t)picture.width * 3;
    target.sample = ISOPHOTE_SAMPLE_U8;
    target.channels = 3;
    target.width = picture.width;
    target.height = picture.height;
    input.name = "color";
    input.image.data = picture.data;
    input.image.row_stride = target.row_stride;
    input.image.sample = target.sample;
    input.image.channels = target.channels;
    input.image.width = target.width;
    input.image.height = target.height;
    control.user = &done;
    control.progress = progress;
    api->request_init(picture.width, picture.height, &request);
    check(api, graph, argv[4],
          api->process(graph, cpu, &request, &input, 1, NULL, &target, &control, &report));
    write_ppm(argv[3], picture);
    printf("%ux%u pixels, %.0f %% done, %llu samples replaced\n", picture.width, picture.height, done * 100.0,
           (unsigned long long)report.replaced);

    free(picture.data);
    api->graph_destroy(graph);
    api->trim();
    dlclose(library);
    return 0;
}
