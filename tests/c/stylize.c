/* Lists the nodes, builds a graph by ids, and stylizes a PPM.
 *
 * stylize LIBRARY IN.ppm OUT.ppm NODE [param=value ...]
 */
#include "load.h"

typedef struct Picture {
    unsigned char *data;
    uint32_t width, height;
} Picture;

static Picture read_ppm(const char *path)
{
    Picture picture;
    unsigned most;
    FILE *file = fopen(path, "rb");

    if (file == NULL)
        fail(path, "cannot be opened");
    if (fscanf(file, "P6 %u %u %u", &picture.width, &picture.height, &most) != 3 || most != 255)
        fail(path, "is not a binary PPM of 8 bits");
    if (picture.width == 0 || picture.height == 0 || picture.width > 16384 || picture.height > 16384)
        fail(path, "has an impossible size");
    fgetc(file);
    picture.data = malloc((size_t)picture.width * picture.height * 3);
    if (picture.data == NULL)
        fail(path, "does not fit into memory");
    if (fread(picture.data, (size_t)picture.width * 3, picture.height, file) != picture.height)
        fail(path, "ends early");
    fclose(file);
    return picture;
}

static void write_ppm(const char *path, Picture picture)
{
    FILE *file = fopen(path, "wb");

    if (file == NULL)
        fail(path, "cannot be created");
    fprintf(file, "P6\n%u %u\n255\n", picture.width, picture.height);
    if (fwrite(picture.data, (size_t)picture.width * 3, picture.height, file) != picture.height)
        fail(path, "cannot be written");
    if (fclose(file) != 0)
        fail(path, "cannot be written");
}

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
          api->process(graph, 0, &request, &input, 1, NULL, &target, &control, &report));
    write_ppm(argv[3], picture);
    printf("%ux%u pixels, %.0f %% done, %llu samples replaced\n", picture.width, picture.height, done * 100.0,
           (unsigned long long)report.replaced);

    free(picture.data);
    api->graph_destroy(graph);
    api->trim();
    dlclose(library);
    return 0;
}
