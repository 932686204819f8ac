// The header is C++17 too: structs can be made, constants compared, the entry point declared.
#include "isophote.h"

static_assert(ISOPHOTE_ABI_VERSION == 1, "these programs are written for version 1");
static_assert(sizeof(IsophoteStatus) == 4, "statuses have a fixed size");

int main()
{
    IsophoteRequest request{};
    request.scale = 1.0f;
    IsophoteEntry entry = nullptr;
    const IsophoteApi *api = entry ? entry(ISOPHOTE_ABI_VERSION) : nullptr;
    return api == nullptr && request.guides == 0 ? 0 : 1;
}
