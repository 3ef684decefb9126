/* What FMI 2.0 and 3.0 have in common: types, statuses, the state of an instance as a whole. */
#ifndef FMI_H
#define FMI_H

#include <stdlib.h>
#include <string.h>

#include "model.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* The standard hands over more than a map can use. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#elif defined(_MSC_VER)
#pragma warning(disable : 4100)
#endif

/* What the standard calls fmi2Status and fmi3Status; only these are returned. */
enum { OK = 0, DISCARD = 2, ERROR = 3 };

typedef unsigned int Reference;
typedef const char *Text;

static int copy_state(void **to, const void *from)
{
    if (!*to)
        *to = malloc(sizeof(Model));
    if (!*to)
        return ERROR;
    memcpy(*to, from, sizeof(Model));
    return OK;
}

static int read_numbers(Model *model, const Reference references[], size_t count, double values[])
{
    size_t i;
    for (i = 0; i < count; i++)
        if (!model_get(model, references[i], &values[i]))
            return ERROR;
    return OK;
}

static int write_numbers(Model *model, const Reference references[], size_t count, const double values[])
{
    size_t i;
    for (i = 0; i < count; i++)
        if (!model_set(model, references[i], values[i]))
            return ERROR;
    return OK;
}

/* Sums of slopes times seeds: for each unknown over the knowns, or (adjoint) for each known over the unknowns. */
static int slope_sums(Model *model, const Reference unknowns[], size_t unknown_count, const Reference knowns[],
    size_t known_count, const double seeds[], double values[], int adjoint)
{
    size_t i, j;
    memset(values, 0, (adjoint ? known_count : unknown_count) * sizeof(double));
    for (i = 0; i < unknown_count; i++) {
        for (j = 0; j < known_count; j++) {
            double slope;
            if (!model_slope(model, unknowns[i], knowns[j], &slope))
                return ERROR;
            values[adjoint ? j : i] += slope * seeds[adjoint ? i : j];
        }
    }
    return OK;
}

/* The functions that keep an instance's state; the versions write its name, and that of reading bytes, their own way. */
#define STATE_FUNCTIONS(FMI, STATE, DESERIALIZE, BYTE)                                                                 \
    EXPORT int FMI##Get##STATE(Model *model, void **state) { return copy_state(state, model); }                        \
    EXPORT int FMI##Set##STATE(Model *model, void *state)                                                              \
    {                                                                                                                  \
        memcpy(model, state, sizeof(Model));                                                                           \
        return OK;                                                                                                     \
    }                                                                                                                  \
    EXPORT int FMI##Free##STATE(Model *model, void **state)                                                            \
    {                                                                                                                  \
        free(*state);                                                                                                  \
        *state = NULL;                                                                                                 \
        return OK;                                                                                                     \
    }                                                                                                                  \
    EXPORT int FMI##Serialized##STATE##Size(Model *model, void *state, size_t *size)                                   \
    {                                                                                                                  \
        *size = sizeof(Model);                                                                                         \
        return OK;                                                                                                     \
    }                                                                                                                  \
    EXPORT int FMI##Serialize##STATE(Model *model, void *state, BYTE bytes[], size_t size)                             \
    {                                                                                                                  \
        if (size < sizeof(Model))                                                                                      \
            return ERROR;                                                                                              \
        memcpy(bytes, state, sizeof(Model));                                                                           \
        return OK;                                                                                                     \
    }                                                                                                                  \
    EXPORT int FMI##DESERIALIZE(Model *model, const BYTE bytes[], size_t size, void **state)                           \
    {                                                                                                                  \
        return size < sizeof(Model) ? ERROR : copy_state(state, bytes);                                                \
    }

/* Functions that are the same in both versions, but for their names. */
#define PLAIN_FUNCTIONS(FMI)                                                                                           \
    EXPORT void FMI##FreeInstance(Model *model) { free(model); }                                                       \
    EXPORT int FMI##ExitInitializationMode(Model *model) { return model ? OK : ERROR; }                                \
    EXPORT int FMI##Terminate(Model *model) { return model ? OK : ERROR; }                                             \
    EXPORT int FMI##Reset(Model *model)                                                                                \
    {                                                                                                                  \
        model_reset(model);                                                                                            \
        return OK;                                                                                                     \
    }

#endif
