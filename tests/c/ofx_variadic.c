/* The functions of the OpenFX suites that take a variable number of arguments, for the test host: Rust
   can call such functions and not define them. They gather the arguments and hand them on. */

#include <stdarg.h>
#include <stdio.h>

#define MOST 8

typedef int (*Count)(void *param);
typedef int (*Get)(void *param, double time, int count, void **places);
typedef char (*Kind)(void *param);
typedef int (*Set)(void *param, int count, const int *whole, const double *numbers, const char *text);
typedef int (*Said)(void *handle, const char *type, const char *text);

static Count count_of;
static Get get;
static Kind kind_of;
static Set set;
static Said said;

void ofx_shim_install(Count count_function, Get get_function, Kind kind_function, Set set_function,
                      Said said_function) {
  count_of = count_function;
  get = get_function;
  kind_of = kind_function;
  set = set_function;
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

int ofx_shim_set(void *param, ...) {
  int whole[MOST] = {0};
  double numbers[MOST] = {0};
  const char *text = NULL;
  int count = count_of(param);
  char kind = kind_of(param);
  va_list list;
  va_start(list, param);
  for (int i = 0; i < count && i < MOST; i++) {
    if (kind == 'i') whole[i] = va_arg(list, int);
    if (kind == 'd') numbers[i] = va_arg(list, double);
    if (kind == 's') text = va_arg(list, const char *);
  }
  va_end(list);
  return set(param, count, whole, numbers, text);
}

// Natron takes the list of arguments for the first of them, so that a format that asks for any shows nothing of it.
static int asks_for_arguments(const char *format) {
  for (; *format; format++)
    if (*format == '%' && *++format != '%') return 1;
  return 0;
}

int ofx_shim_message(void *handle, const char *type, const char *id, const char *format, ...) {
  char text[1024];
  va_list list;
  (void)id;
  va_start(list, format);
  vsnprintf(text, sizeof text, asks_for_arguments(format) ? "" : format, list);
  va_end(list);
  return said(handle, type, text);
}
