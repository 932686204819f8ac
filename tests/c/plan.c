/* Asks for the plan of a graph as data and prints its textures, passes and shaders.
 *
 * plan LIBRARY WIDTH HEIGHT NODE [param=value ...]
 */
#include "load.h"

static const char *const ROLES[] = {"input", "output", "transient"};
static const char *const FORMATS[] = {"r32float", "rg32float", "rgba32float"};
static const char *const LANGUAGES[] = {"WGSL", "SPIR-V", "HLSL", "MSL", "GLSL"};
static const char *const KINDS[] = {"uniform", "sampled", "storage"};

static void show_shader(const IsophoteApi *api, IsophotePlan plan, uint32_t pass, IsophoteLanguage language)
{
    const IsophoteShader *shader;
    uint32_t i;

    if (api->plan_shader(plan, pass, language, &shader) != ISOPHOTE_OK) {
        char message[512] = "";
        IsophoteText text = {message, sizeof message, 0};
        api->plan_error(plan, &text);
        fail("plan_shader", message);
    }
    printf("  %s, %lu bytes, entry point %s:", LANGUAGES[language], (unsigned long)shader->size,
           shader->entry_point);
    for (i = 0; i < shader->binding_count; i++)
        printf(" %s=%s %u", shader->bindings[i].name, KINDS[shader->bindings[i].kind],
               shader->bindings[i].slot);
    printf("\n");
    if (language == ISOPHOTE_LANGUAGE_SPIRV) {
        printf("    magic %08x\n", *(const uint32_t *)shader->code);
    } else {
        const char *text = shader->code;
        printf("    %.*s\n", (int)strcspn(text, "\n"), text);
    }
}

int main(int argc, char **argv)
{
    char message[512];
    IsophoteText error = {message, sizeof message, 0};
    void *library;
    const IsophoteApi *api;
    const IsophoteTexture *textures;
    const IsophotePass *passes;
    IsophoteRequest request;
    IsophoteGraph graph;
    IsophotePlan plan;
    IsophoteChange change;
    uint32_t texture_count, pass_count, i, j;

    if (argc < 5) {
        fprintf(stderr, "usage: plan LIBRARY WIDTH HEIGHT NODE [param=value ...]\n");
        return 2;
    }
    api = load(argv[1], &library);
    graph = build(api, argv[4], argv + 5, argc - 5);
    api->request_init((uint32_t)atoi(argv[2]), (uint32_t)atoi(argv[3]), &request);
    if (api->plan_create(graph, &request, NULL, &error, &plan) != ISOPHOTE_OK)
        fail("plan_create", message);
    /* The plan needs its graph for updates only; this one changes nothing. */
    if (api->plan_update(plan, graph, NULL, &change) != ISOPHOTE_OK || change != ISOPHOTE_CHANGE_UNIFORMS)
        fail("plan_update", "an unchanged graph changed the plan");
    api->graph_destroy(graph);

    api->plan_textures(plan, &textures, &texture_count);
    for (i = 0; i < texture_count; i++)
        printf("texture %u: %s %s, %ux%u %s\n", i, ROLES[textures[i].role],
               textures[i].name ? textures[i].name : "-", textures[i].width, textures[i].height,
               FORMATS[textures[i].format]);
    api->plan_passes(plan, &passes, &pass_count);
    for (i = 0; i < pass_count; i++) {
        const IsophotePass *pass = &passes[i];
        printf("pass %u: %s, uniforms of %u and %u bytes, %ux%ux%u workgroups, reads", i, pass->kernel,
               pass->grid_size, pass->params_size, pass->workgroups[0], pass->workgroups[1],
               pass->workgroups[2]);
        for (j = 0; j < pass->input_count; j++)
            printf(" %u", pass->inputs[j]);
        printf(", writes");
        for (j = 0; j < pass->output_count; j++)
            printf(" %u", pass->outputs[j]);
        printf("\n");
        for (j = ISOPHOTE_LANGUAGE_WGSL; j <= ISOPHOTE_LANGUAGE_GLSL; j++)
            show_shader(api, plan, i, j);
    }
    api->plan_destroy(plan);
    dlclose(library);
    return 0;
}
