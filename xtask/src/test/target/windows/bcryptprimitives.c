/* The one function of Windows' bcryptprimitives.dll that Rust's standard library takes random numbers from: Wine 8, which
 * Debian 12 has, has no such library. Tests alone use it. */
#include <stddef.h>
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID bytes, ULONG size);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T size) {
    return SystemFunction036(bytes, (ULONG)size);
}
