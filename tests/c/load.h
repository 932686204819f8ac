/* Loads the library by path and gives its table; what the C programs here share. Not all of them need all of it. */
#ifndef LOAD_H
#define LOAD_H

#include "isophote.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Says what went wrong and ends the program. */
static void fail(const char *what, const char *why)
{
    fprintf(stderr, "%s: %s\n", what, why);
    exit(1);
}

static const IsophoteApi *load(const char *path, void **library)
{
    IsophoteEntry entry;
    const IsophoteApi *api;

    *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (*library == NULL)
        fail(path, dlerror());
    /* ISO C has no cast from an object pointer to a function pointer. */
    *(void **)(&entry) = dlsym(*library, "isophote_api");
    if (entry == NULL)
        fail(path, "it has no symbol isophote_api");
    api = entry(ISOPHOTE_ABI_VERSION);
    if (api == NULL)
        fail(path, "it does not offer the ABI version of this program's header");
    return api;
}

/* Ends the program, with the graph's own message, unless the call was a success. */
static void check(const IsophoteApi *api, IsophoteGraph graph, const char *what, IsophoteStatus status)
{
    char message[512] = "";
    IsophoteText text = {message, sizeof message, 0};

    if (status == ISOPHOTE_OK)
        return;
    api->graph_error(graph, &text);
    fprintf(stderr, "%s: %s: %s\n", what, api->status_name(status), message);
    exit(1);
}

/* Adds the node `id`, gives it the colour and, where it takes one, the tensor of `tensor`. */
static inline uint32_t add(const IsophoteApi *api, IsophoteGraph graph, const char *id, uint32_t tensor)
{
    const IsophoteNode *spec;
    uint32_t node, i;

    check(api, graph, id, api->graph_add(graph, id, id, &node));
    check(api, graph, id, api->graph_spec(graph, node, &spec));
    for (i = 0; i < spec->input_count; i++) {
        const IsophotePort *port = &spec->inputs[i];
        if (port->kind == ISOPHOTE_KIND_COLOR)
            check(api, graph, id, api->graph_connect_input(graph, "color", node, port->id));
        else if (port->kind == ISOPHOTE_KIND_TENSOR && tensor != node)
            check(api, graph, id, api->graph_connect(graph, tensor, node, port->id));
    }
    return node;
}

/* A graph of the structure tensor and of `id`, which gives what leaves it; `settings` are `param=value`. */
static inline IsophoteGraph build(const IsophoteApi *api, const char *id, char **settings, int count)
{
    char message[512];
    IsophoteText error = {message, sizeof message, 0};
    IsophoteGraph graph;
    uint32_t tensor, node;
    int i;

    if (api->graph_create(&error, &graph) != ISOPHOTE_OK)
        fail("graph_create", message);
    tensor = add(api, graph, "structure_tensor", 0);
    node = add(api, graph, id, tensor);
    check(api, graph, id, api->graph_set_output(graph, node));
    for (i = 0; i < count; i++) {
        char *equals = strchr(settings[i], '=');
        if (equals == NULL)
            fail(settings[i], "a setting is param=value");
        *equals = '\0';
        check(api, graph, settings[i], api->graph_set_text(graph, node, settings[i], equals + 1));
    }
    return graph;
}

#endif
