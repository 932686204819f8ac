/* The functions of the OpenFX suites that take a variable number of arguments, for the test host: Rust
   can call such functions and not define them. They gather the arguments and hand them on. */

#include <stdarg.h>
#include <stdio.h>

#define MOST 8

typedef int (*Count)(void *param);
typedef int (*Get)(void *param, double time, int count, void **places);
typedef int (*Said)(void *handle, const char *type, const char *text);

static Count count_of;
static Get get;
static Said said;

void ofx_shim_install(Count count_function, Get get_function, Said said_function) {
  count_of = count_function;
  get = get_function;
  said = said_function;
}

static int gather(void *param, double time, va_list list) {
  void *places[MOST] = {0};
  int count = count_of(param);
  for (int i = 0; i < count && i < MOST; i++) places[i] = va_arg(list, void *);
  return get(param, time, count, places);
}

int ofx_shim_get(void *param, ...) {
  va_list list;
  va_start(list, param);
  int status = gather(param, 0.0, list);
  va_end(list);
  return status;
}

int ofx_shim_get_at(void *param, double time, ...) {
  va_list list;
  va_start(list, time);
  int status = gather(param, time, list);
  va_end(list);
  return status;
}

int ofx_shim_message(void *handle, const char *type, const char *id, const char *format, ...) {
  char text[1024];
  va_list list;
  (void)id;
  va_start(list, format);
  vsnprintf(text, sizeof text, format, list);
  va_end(list);
  return said(handle, type, text);
}
