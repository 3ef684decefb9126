/* The model behind the functions of FMI 3.0 for co-simulation. What the model has nothing of is refused. */
#include "model.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

/* What the standard calls fmi3Status; only these are returned. */
enum { OK = 0, ERROR = 3 };
enum { DEPENDENT = 5 }; /* how an output depends on an input, neither fixed nor by a constant factor */

typedef uint32_t Reference;
typedef const char *Text;

EXPORT Text fmi3GetVersion(void) { return "3.0"; }

EXPORT int fmi3SetDebugLogging(void *model, bool on, size_t count, const Text categories[])
{
    (void)model, (void)on, (void)count, (void)categories;
    return OK;
}

EXPORT void *fmi3InstantiateCoSimulation(Text name, Text token, Text resources, bool visible, bool log, bool events,
    bool early, const Reference intermediate[], size_t count, void *environment, void (*say)(void), void (*update)(void))
{
    (void)name, (void)resources, (void)visible, (void)log, (void)events, (void)early, (void)intermediate;
    (void)count, (void)environment, (void)say, (void)update;
    return model_new(token);
}

EXPORT void *fmi3InstantiateModelExchange(Text name, Text token, Text resources, bool visible, bool log,
    void *environment, void (*say)(void))
{
    (void)name, (void)token, (void)resources, (void)visible, (void)log, (void)environment, (void)say;
    return NULL;
}

EXPORT void *fmi3InstantiateScheduledExecution(Text name, Text token, Text resources, bool visible, bool log,
    void *environment, void (*say)(void), void (*clock)(void), void (*lock)(void), void (*unlock)(void))
{
    (void)name, (void)token, (void)resources, (void)visible, (void)log, (void)environment, (void)say;
    (void)clock, (void)lock, (void)unlock;
    return NULL;
}

EXPORT void fmi3FreeInstance(void *model) { free(model); }

EXPORT int fmi3EnterInitializationMode(void *model, bool tolerant, double tolerance, double start, bool stops, double stop)
{
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    ((Model *)model)->time = start;
    return OK;
}

EXPORT int fmi3ExitInitializationMode(void *model) { return model ? OK : ERROR; }
EXPORT int fmi3Terminate(void *model) { return model ? OK : ERROR; }

EXPORT int fmi3Reset(void *model)
{
    model_reset((Model *)model);
    return OK;
}

/* Events, a configuration and steps that one can enter: modes that the description does not offer. */
EXPORT int fmi3EnterEventMode(void *model) { (void)model; return ERROR; }
EXPORT int fmi3EnterStepMode(void *model) { (void)model; return ERROR; }
EXPORT int fmi3EnterConfigurationMode(void *model) { (void)model; return ERROR; }
EXPORT int fmi3ExitConfigurationMode(void *model) { (void)model; return ERROR; }
EXPORT int fmi3EvaluateDiscreteStates(void *model) { (void)model; return ERROR; }

EXPORT int fmi3UpdateDiscreteStates(void *model, bool *more, bool *ends, bool *nominals, bool *values, bool *timed,
    double *next)
{
    (void)model, (void)more, (void)ends, (void)nominals, (void)values, (void)timed, (void)next;
    return ERROR;
}

/* Numbers are of the type Float64, the flag is Boolean; there are no variables of any other type. */
EXPORT int fmi3GetFloat64(void *model, const Reference references[], size_t count, double values[], size_t size)
{
    size_t i;
    if (size < count)
        return ERROR;
    for (i = 0; i < count; i++)
        if (!model_get((Model *)model, references[i], &values[i]))
            return ERROR;
    return OK;
}

EXPORT int fmi3SetFloat64(void *model, const Reference references[], size_t count, const double values[], size_t size)
{
    size_t i;
    if (size < count)
        return ERROR;
    for (i = 0; i < count; i++)
        if (!model_set((Model *)model, references[i], values[i]))
            return ERROR;
    return OK;
}

EXPORT int fmi3GetBoolean(void *model, const Reference references[], size_t count, bool values[], size_t size)
{
    size_t i;
    if (size < count)
        return ERROR;
    for (i = 0; i < count; i++) {
        if (references[i] != MODEL_VALID)
            return ERROR;
        values[i] = model_is_valid((Model *)model) != 0;
    }
    return OK;
}

#define NONE_OF(NAME, TYPE)                                                                                            \
    EXPORT int fmi3Get##NAME(void *model, const Reference references[], size_t count, TYPE values[], size_t size)      \
    {                                                                                                                  \
        (void)model, (void)references, (void)values, (void)size;                                                       \
        return count ? ERROR : OK;                                                                                     \
    }                                                                                                                  \
    NO_INPUT_OF(NAME, TYPE)

#define NO_INPUT_OF(NAME, TYPE)                                                                                        \
    EXPORT int fmi3Set##NAME(void *model, const Reference references[], size_t count, const TYPE values[],             \
        size_t size)                                                                                                   \
    {                                                                                                                  \
        (void)model, (void)references, (void)values, (void)size;                                                       \
        return count ? ERROR : OK;                                                                                     \
    }

NONE_OF(Float32, float)
NONE_OF(Int8, int8_t)
NONE_OF(UInt8, uint8_t)
NONE_OF(Int16, int16_t)
NONE_OF(UInt16, uint16_t)
NONE_OF(Int32, int32_t)
NONE_OF(UInt32, uint32_t)
NONE_OF(Int64, int64_t)
NONE_OF(UInt64, uint64_t)
NONE_OF(String, Text)
NO_INPUT_OF(Boolean, bool)

EXPORT int fmi3GetBinary(void *model, const Reference references[], size_t count, size_t sizes[], const uint8_t *values[],
    size_t size)
{
    (void)model, (void)references, (void)sizes, (void)values, (void)size;
    return count ? ERROR : OK;
}

EXPORT int fmi3SetBinary(void *model, const Reference references[], size_t count, const size_t sizes[],
    const uint8_t *const values[], size_t size)
{
    (void)model, (void)references, (void)sizes, (void)values, (void)size;
    return count ? ERROR : OK;
}

EXPORT int fmi3GetClock(void *model, const Reference references[], size_t count, bool values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi3SetClock(void *model, const Reference references[], size_t count, const bool values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

/* Every output depends on every input. */
EXPORT int fmi3GetNumberOfVariableDependencies(void *model, Reference reference, size_t *count)
{
    (void)model;
    *count = reference >= MAP_INPUTS && reference <= MODEL_VALID ? MAP_INPUTS : 0;
    return OK;
}

EXPORT int fmi3GetVariableDependencies(void *model, Reference dependent, size_t elements[], Reference independents[],
    size_t others[], int kinds[], size_t count)
{
    size_t i;
    (void)model;
    if (dependent < MAP_INPUTS || dependent > MODEL_VALID || count > MAP_INPUTS)
        return ERROR;
    for (i = 0; i < count; i++) {
        elements[i] = others[i] = 0;
        independents[i] = (Reference)i;
        kinds[i] = DEPENDENT;
    }
    return OK;
}

EXPORT int fmi3GetFMUState(void *model, void **state)
{
    if (!*state)
        *state = malloc(sizeof(Model));
    if (!*state)
        return ERROR;
    memcpy(*state, model, sizeof(Model));
    return OK;
}

EXPORT int fmi3SetFMUState(void *model, void *state)
{
    memcpy(model, state, sizeof(Model));
    return OK;
}

EXPORT int fmi3FreeFMUState(void *model, void **state)
{
    (void)model;
    free(*state);
    *state = NULL;
    return OK;
}

EXPORT int fmi3SerializedFMUStateSize(void *model, void *state, size_t *size)
{
    (void)model, (void)state;
    *size = sizeof(Model);
    return OK;
}

EXPORT int fmi3SerializeFMUState(void *model, void *state, uint8_t bytes[], size_t size)
{
    (void)model;
    if (size < sizeof(Model))
        return ERROR;
    memcpy(bytes, state, sizeof(Model));
    return OK;
}

EXPORT int fmi3DeserializeFMUState(void *model, const uint8_t bytes[], size_t size, void **state)
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

EXPORT int fmi3GetDirectionalDerivative(void *model, const Reference unknowns[], size_t unknown_count,
    const Reference knowns[], size_t known_count, const double seeds[], size_t seed_count, double values[],
    size_t value_count)
{
    size_t i, j;
    if (seed_count < known_count || value_count < unknown_count)
        return ERROR;
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

EXPORT int fmi3GetAdjointDerivative(void *model, const Reference unknowns[], size_t unknown_count,
    const Reference knowns[], size_t known_count, const double seeds[], size_t seed_count, double values[],
    size_t value_count)
{
    size_t i, j;
    if (seed_count < unknown_count || value_count < known_count)
        return ERROR;
    for (j = 0; j < known_count; j++) {
        values[j] = 0.0;
        for (i = 0; i < unknown_count; i++) {
            double slope;
            if (!model_slope((Model *)model, unknowns[i], knowns[j], &slope))
                return ERROR;
            values[j] += slope * seeds[i];
        }
    }
    return OK;
}

/* Clocks: there are none. */
EXPORT int fmi3GetIntervalDecimal(void *model, const Reference references[], size_t count, double values[], int kinds[])
{
    (void)model, (void)references, (void)values, (void)kinds;
    return count ? ERROR : OK;
}

EXPORT int fmi3GetIntervalFraction(void *model, const Reference references[], size_t count, uint64_t counters[],
    uint64_t resolutions[], int kinds[])
{
    (void)model, (void)references, (void)counters, (void)resolutions, (void)kinds;
    return count ? ERROR : OK;
}

EXPORT int fmi3GetShiftDecimal(void *model, const Reference references[], size_t count, double values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi3GetShiftFraction(void *model, const Reference references[], size_t count, uint64_t counters[],
    uint64_t resolutions[])
{
    (void)model, (void)references, (void)counters, (void)resolutions;
    return count ? ERROR : OK;
}

EXPORT int fmi3SetIntervalDecimal(void *model, const Reference references[], size_t count, const double values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi3SetIntervalFraction(void *model, const Reference references[], size_t count, const uint64_t counters[],
    const uint64_t resolutions[])
{
    (void)model, (void)references, (void)counters, (void)resolutions;
    return count ? ERROR : OK;
}

EXPORT int fmi3SetShiftDecimal(void *model, const Reference references[], size_t count, const double values[])
{
    (void)model, (void)references, (void)values;
    return count ? ERROR : OK;
}

EXPORT int fmi3SetShiftFraction(void *model, const Reference references[], size_t count, const uint64_t counters[],
    const uint64_t resolutions[])
{
    (void)model, (void)references, (void)counters, (void)resolutions;
    return count ? ERROR : OK;
}

EXPORT int fmi3GetOutputDerivatives(void *model, const Reference references[], size_t count, const int32_t orders[],
    double values[], size_t size)
{
    (void)model, (void)references, (void)orders, (void)values, (void)size;
    return count ? ERROR : OK;
}

EXPORT int fmi3ActivateModelPartition(void *model, Reference clock, double time)
{
    (void)model, (void)clock, (void)time;
    return ERROR;
}

/* Model exchange, which the description does not offer: some importers look for these names in every unit. */
EXPORT int fmi3EnterContinuousTimeMode(void *model) { (void)model; return ERROR; }

EXPORT int fmi3CompletedIntegratorStep(void *model, bool keeps, bool *event, bool *ends)
{
    (void)model, (void)keeps, (void)event, (void)ends;
    return ERROR;
}

EXPORT int fmi3SetTime(void *model, double time) { (void)model, (void)time; return ERROR; }

#define NO_STATES(NAME, TYPE)                                                                                          \
    EXPORT int fmi3##NAME(void *model, TYPE values[], size_t count)                                                    \
    {                                                                                                                  \
        (void)model, (void)values, (void)count;                                                                        \
        return ERROR;                                                                                                  \
    }

NO_STATES(SetContinuousStates, const double)
NO_STATES(GetContinuousStates, double)
NO_STATES(GetContinuousStateDerivatives, double)
NO_STATES(GetNominalsOfContinuousStates, double)
NO_STATES(GetEventIndicators, double)

EXPORT int fmi3GetNumberOfContinuousStates(void *model, size_t *count)
{
    (void)model;
    *count = 0;
    return OK;
}

EXPORT int fmi3GetNumberOfEventIndicators(void *model, size_t *count)
{
    (void)model;
    *count = 0;
    return OK;
}

EXPORT int fmi3DoStep(void *model, double time, double step, bool keeps, bool *event, bool *ends, bool *early, double *last)
{
    (void)keeps;
    ((Model *)model)->time = time + step;
    *event = *ends = *early = false;
    *last = time + step;
    return OK;
}
