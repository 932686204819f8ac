/* Lists the nodes. Linked to the library by the linker, where the other programs here load it themselves.
 *
 * linked
 */
#include "isophote.h"

#include <stdio.h>

int main(void)
{
    const IsophoteApi *api = isophote_api(ISOPHOTE_ABI_VERSION);
    IsophoteCatalogue catalogue;
    uint32_t i;

    if (api == NULL) {
        fprintf(stderr, "the library does not offer the version of this program's header\n");
        return 1;
    }
    if (api->catalogue(&catalogue) != ISOPHOTE_OK) {
        fprintf(stderr, "the library does not give its catalogue\n");
        return 1;
    }
    printf("Isophote %s, %u nodes\n", api->version, (unsigned)catalogue.node_count);
    for (i = 0; i < catalogue.node_count; i++)
        printf("%s: %s\n", catalogue.nodes[i].id, catalogue.nodes[i].label);
    return 0;
}
