/* The model behind the functions of FMI 2.0 for co-simulation. */
#include "model.h"

#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* What the standard calls fmi2Status; only these are returned. */
enum { OK = 0, DISCARD = 2, ERROR = 3 };

typedef unsigned int Reference;
typedef const char *Text;

static int read_numbers(Model *model, const Reference *references, size_t count, double *values)
{
    size_t i;
    for (i = 0; i < count; i++)
        if (!model_get(model, references[i], &values[i]))
            return ERROR;
    return OK;
}

EXPORT Text fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Text fmi2GetVersion(void) { return "2.0"; }

EXPORT int fmi2SetDebugLogging(void *model, int on, size_t count, const Text categories[])
{
    (void)model, (void)on, (void)count, (void)categories;
    return OK;
}

EXPORT void *fmi2Instantiate(Text name, int type, Text guid, Text resources, const void *callbacks, int visible, int log)
{
    (void)name, (void)resources, (void)callbacks, (void)visible, (void)log;
    return type == 1 ? model_new(guid) : NULL; /* 1: co-simulation */
}

EXPORT void fmi2FreeInstance(void *model) { free(model); }

EXPORT int fmi2SetupExperiment(void *model, int tolerant, double tolerance, double start, int stops, double stop)
{
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    ((Model *)model)->time = start;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(void *model) { return model ? OK : ERROR; }
EXPORT int fmi2ExitInitializationMode(void *model) { return model ? OK : ERROR; }
EXPORT int fmi2Terminate(void *model) { return model ? OK : ERROR; }

EXPORT int fmi2Reset(void *model)
{
    model_reset((Model *)model);
    return OK;
}

EXPORT int fmi2GetReal(void *model, const Reference references[], size_t count, double values[])
{
    return read_numbers((Model *)model, references, count, values);
}

EXPORT int fmi2GetInteger(void *model, const Reference references[], size_t count, int values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2GetBoolean(void *model, const Reference references[], size_t count, int values[])
{
    size_t i;
    for (i = 0; i < count; i++) {
        if (references[i] != MODEL_VALID)
            return ERROR;
        values[i] = model_is_valid((Model *)model);
    }
    return OK;
}

EXPORT int fmi2GetString(void *model, const Reference references[], size_t count, Text values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2SetReal(void *model, const Reference references[], size_t count, const double values[])
{
    size_t i;
    for (i = 0; i < count; i++)
        if (!model_set((Model *)model, references[i], values[i]))
            return ERROR;
    return OK;
}

EXPORT int fmi2SetInteger(void *model, const Reference references[], size_t count, const int values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2SetBoolean(void *model, const Reference references[], size_t count, const int values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2SetString(void *model, const Reference references[], size_t count, const Text values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2GetFMUstate(void *model, void **state)
{
    if (!*state)
        *state = malloc(sizeof(Model));
    if (!*state)
        return ERROR;
    memcpy(*state, model, sizeof(Model));
    return OK;
}

EXPORT int fmi2SetFMUstate(void *model, void *state)
{
    memcpy(model, state, sizeof(Model));
    return OK;
}

EXPORT int fmi2FreeFMUstate(void *model, void **state)
{
    (void)model;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int fmi2SerializedFMUstateSize(void *model, void *state, size_t *size)
{
    (void)model, (void)state;
    *size = sizeof(Model);
    return OK;
}

EXPORT int fmi2SerializeFMUstate(void *model, void *state, char bytes[], size_t size)
{
    (void)model;
    if (size < sizeof(Model))
        return ERROR;
    memcpy(bytes, state, sizeof(Model));
    return OK;
}

EXPORT int fmi2DeSerializeFMUstate(void *model, const char bytes[], size_t size, void **state)
{
    (void)model;
    if (size < sizeof(Model))
        return ERROR;
    if (!*state)
        *state = malloc(sizeof(Model));
    if (!*state)
        return ERROR;
    memcpy(*state, bytes, sizeof(Model));
    return OK;
}

EXPORT int fmi2GetDirectionalDerivative(void *model, const Reference unknowns[], size_t unknown_count,
    const Reference knowns[], size_t known_count, const double seeds[], double values[])
{
    size_t i, j;
    for (i = 0; i < unknown_count; i++) {
        values[i] = 0.0;
        for (j = 0; j < known_count; j++) {
            double slope;
            if (!model_slope((Model *)model, unknowns[i], knowns[j], &slope))
                return ERROR;
            values[i] += slope * seeds[j];
        }
    }
    return OK;
}

EXPORT int fmi2SetRealInputDerivatives(void *model, const Reference references[], size_t count, const int orders[],
    const double values[])
{
    (void)model, (void)references, (void)orders, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2GetRealOutputDerivatives(void *model, const Reference references[], size_t count, const int orders[],
    double values[])
{
    (void)model, (void)references, (void)orders, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi2DoStep(void *model, double time, double step, int keeps)
{
    (void)keeps;
    ((Model *)model)->time = time + step;
    return OK;
}

EXPORT int fmi2CancelStep(void *model)
{
    (void)model;
    return ERROR; /* no step is under way when this may be called */
}

/* A step is done when its call returns: nothing is pending that could be asked for. */
EXPORT int fmi2GetStatus(void *model, int kind, int *value)
{
    (void)model, (void)kind, (void)value;
    return DISCARD;
}

EXPORT int fmi2GetRealStatus(void *model, int kind, double *value)
{
    if (kind != 2)
        return DISCARD;
    *value = ((Model *)model)->time; /* the last time that was reached */
    return OK;
}

EXPORT int fmi2GetIntegerStatus(void *model, int kind, int *value)
{
    (void)model, (void)kind, (void)value;
    return DISCARD;
}

EXPORT int fmi2GetBooleanStatus(void *model, int kind, int *value)
{
    (void)model;
    if (kind != 3)
        return DISCARD;
    *value = 0; /* it does not ask for the end */
    return OK;
}

EXPORT int fmi2GetStringStatus(void *model, int kind, Text *value)
{
    (void)model, (void)kind, (void)value;
    return DISCARD;
}
