/* Compiled only, as C and as C++ of several standards: every object of the header, and calls with each.
 *
 * With WRONG defined it confuses two handles, which no compiler may take.
 */
#include "isophote.h"
/* A second time, as headers that include it may. */
#include "isophote.h"

IsophoteStatus try_objects(const IsophoteApi *api, IsophoteText *error);

IsophoteStatus try_objects(const IsophoteApi *api, IsophoteText *error)
{
    IsophoteEntry entry = isophote_api;
    IsophoteGraph graph = {0};
    IsophotePlan plan = {0};
    IsophoteDevice device = {0};
    IsophoteRequest request;
    IsophoteChange change = ISOPHOTE_CHANGE_UNIFORMS;
    const IsophoteShader *shader = NULL;

    if (entry(ISOPHOTE_ABI_VERSION) != api || api->extension("none") != NULL)
        return ISOPHOTE_ERROR_UNSUPPORTED;
    if (api->graph_create(error, &graph) != ISOPHOTE_OK || api->request_init(8, 8, &request) != ISOPHOTE_OK ||
        api->device_create("software", error, &device) != ISOPHOTE_OK)
        return ISOPHOTE_ERROR_NO_DEVICE;
#ifdef WRONG
    graph = plan;
#endif
    request.alpha = ISOPHOTE_ALPHA_EMISSIVE;
    request.guides = ISOPHOTE_GUIDE_MASK | ISOPHOTE_GUIDE_FLOW;
    if (api->plan_create(graph, &request, NULL, error, &plan) != ISOPHOTE_OK ||
        api->plan_update(plan, graph, &request, &change) != ISOPHOTE_OK)
        return ISOPHOTE_ERROR_CONNECTION;
    if (api->plan_shader(plan, 0, ISOPHOTE_LANGUAGE_SPIRV, &shader) != ISOPHOTE_OK)
        return ISOPHOTE_ERROR_UNKNOWN;
    return api->process(graph, device, &request, NULL, 0, NULL, NULL, NULL, NULL);
}
