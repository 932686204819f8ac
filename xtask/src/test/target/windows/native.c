/* A program of Windows that runs one of the system that Wine runs on, waits for it and ends as it does: Wine starts such
 * programs, but tells nobody when they end, and does not hand them pipes. The script of the same name beside it is told a
 * file first, and writes the exit code there. Tests alone use it. */
#include <stdio.h>
#include <windows.h>

#define MOST 32768

static wchar_t own[MOST], script[MOST], file[MOST], line[MOST];

/* What follows the name of the program on a command line. */
static const wchar_t *arguments(const wchar_t *all) {
    int quoted = 0;
    for (; *all && (quoted || (*all != L' ' && *all != L'\t')); all++) {
        quoted ^= *all == L'"';
    }
    return all;
}

int main(void) {
    DWORD length = GetModuleFileNameW(NULL, own, MOST);
    if (length < 5 || length >= MOST - 64) {
        return 127;
    }
    own[length - 4] = 0; /* .exe */
    swprintf(script, MOST, L"%ls.sh", own);
    swprintf(file, MOST, L"%ls-%lu-%lu.code", own, GetCurrentProcessId(), GetTickCount());
    if (swprintf(line, MOST, L"native %ls %ls", file, arguments(GetCommandLineW())) < 0) {
        return 127;
    }
    STARTUPINFOW start = {.cb = sizeof start};
    start.dwFlags = STARTF_USESTDHANDLES;
    start.hStdInput = GetStdHandle(STD_INPUT_HANDLE);
    start.hStdOutput = GetStdHandle(STD_OUTPUT_HANDLE);
    start.hStdError = GetStdHandle(STD_ERROR_HANDLE);
    PROCESS_INFORMATION process;
    if (!CreateProcessW(script, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &process)) {
        return 127;
    }
    /* Ours would keep pipes open that the other program has closed. */
    CloseHandle(start.hStdInput);
    CloseHandle(start.hStdOutput);
    CloseHandle(start.hStdError);
    FILE *told;
    while (!(told = _wfopen(file, L"r"))) {
        Sleep(5);
    }
    int code = 127;
    if (fscanf(told, "%d", &code) != 1) {
        code = 127;
    }
    fclose(told);
    DeleteFileW(file);
    return code;
}
