/* Reads and writes binary PPM files of 8 bits; what the C programs here share. */
#ifndef PPM_H
#define PPM_H

#include "load.h"

typedef struct Picture {
    unsigned char *data;
    uint32_t width, height;
} Picture;

static inline Picture read_ppm(const char *path)
{
    Picture picture;
    unsigned most;
    FILE *file = fopen(path, "rb");

    if (file == NULL)
        fail(path, "cannot be opened");
    if (fscanf(file, "P6 %u %u %u", &picture.width, &picture.height, &most) != 3 || most != 255)
        fail(path, "is not a binary PPM of 8 bits");
    if (picture.width == 0 || picture.height == 0 || picture.width > 16384 || picture.height > 16384)
        fail(path, "has an impossible size");
    fgetc(file);
    picture.data = malloc((size_t)picture.width * picture.height * 3);
    if (picture.data == NULL)
        fail(path, "does not fit into memory");
    if (fread(picture.data, (size_t)picture.width * 3, picture.height, file) != picture.height)
        fail(path, "ends early");
    fclose(file);
    return picture;
}

static inline void write_ppm(const char *path, Picture picture)
{
    FILE *file = fopen(path, "wb");

    if (file == NULL)
        fail(path, "cannot be created");
    fprintf(file, "P6\n%u %u\n255\n", picture.width, picture.height);
    if (fwrite(picture.data, (size_t)picture.width * 3, picture.height, file) != picture.height)
        fail(path, "cannot be written");
    if (fclose(file) != 0)
        fail(path, "cannot be written");
}

#endif
