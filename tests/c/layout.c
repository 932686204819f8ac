/* Prints the size of every struct of the header, and where the table's last function lies. */
#include "isophote.h"

#include <stdio.h>

#define SHOW(type) printf(#type " %lu\n", (unsigned long)sizeof(type))

int main(void)
{
    SHOW(IsophoteText);
    SHOW(IsophoteRect);
    SHOW(IsophoteChoice);
    SHOW(IsophotePort);
    SHOW(IsophoteParam);
    SHOW(IsophoteNode);
    SHOW(IsophoteCatalogue);
    SHOW(IsophoteValue);
    SHOW(IsophoteRequest);
    SHOW(IsophoteImage);
    SHOW(IsophoteTarget);
    SHOW(IsophoteInput);
    SHOW(IsophoteSupport);
    SHOW(IsophotePassTime);
    SHOW(IsophoteControl);
    SHOW(IsophoteReport);
    SHOW(IsophoteTexture);
    SHOW(IsophotePass);
    SHOW(IsophoteBinding);
    SHOW(IsophoteShader);
    SHOW(IsophoteApi);
    SHOW(IsophoteVulkanNeeds);
    SHOW(IsophoteVulkanHost);
    SHOW(IsophoteVulkanImage);
    SHOW(IsophoteVulkanSemaphore);
    SHOW(IsophoteVulkanApi);
    printf("device_name %lu\n", (unsigned long)offsetof(IsophoteApi, device_name));
    return 0;
}
