/* The model behind the functions of FMI 3.0 for co-simulation. What the model has nothing of is refused. */
#include "fmi.h"

#include <stdbool.h>
#include <stdint.h>

enum { DEPENDENT = 5 }; /* how an output depends on an input, neither fixed nor by a constant factor */

EXPORT Text fmi3GetVersion(void) { return "3.0"; }
EXPORT int fmi3SetDebugLogging(Model *model, bool on, size_t count, const Text categories[]) { return OK; }

EXPORT void *fmi3InstantiateCoSimulation(Text name, Text token, Text resources, bool visible, bool log, bool events,
    bool early, const Reference intermediate[], size_t count, void *environment, void (*say)(void), void (*update)(void))
{
    return model_new(token);
}

EXPORT void *fmi3InstantiateModelExchange(Text name, Text token, Text resources, bool visible, bool log,
    void *environment, void (*say)(void))
{
    return NULL;
}

EXPORT void *fmi3InstantiateScheduledExecution(Text name, Text token, Text resources, bool visible, bool log,
    void *environment, void (*say)(void), void (*clock)(void), void (*lock)(void), void (*unlock)(void))
{
    return NULL;
}

EXPORT int fmi3EnterInitializationMode(Model *model, bool tolerant, double tolerance, double start, bool stops, double stop)
{
    model->time = start;
    return OK;
}

PLAIN_FUNCTIONS(fmi3)
STATE_FUNCTIONS(fmi3, FMUState, DeserializeFMUState, uint8_t)

/* Events, a configuration and steps that one can enter: modes that the description does not offer. */
EXPORT int fmi3EnterEventMode(Model *model) { return ERROR; }
EXPORT int fmi3EnterStepMode(Model *model) { return ERROR; }
EXPORT int fmi3EnterConfigurationMode(Model *model) { return ERROR; }
EXPORT int fmi3ExitConfigurationMode(Model *model) { return ERROR; }
EXPORT int fmi3EvaluateDiscreteStates(Model *model) { return ERROR; }

EXPORT int fmi3UpdateDiscreteStates(Model *model, bool *more, bool *ends, bool *nominals, bool *values, bool *timed,
    double *next)
{
    return ERROR;
}

/* Numbers are of the type Float64, the flag is Boolean; there are no variables of any other type. */
EXPORT int fmi3GetFloat64(Model *model, const Reference references[], size_t count, double values[], size_t size)
{
    return size < count ? ERROR : read_numbers(model, references, count, values);
}

EXPORT int fmi3SetFloat64(Model *model, const Reference references[], size_t count, const double values[], size_t size)
{
    return size < count ? ERROR : write_numbers(model, references, count, values);
}

EXPORT int fmi3GetBoolean(Model *model, const Reference references[], size_t count, bool values[], size_t size)
{
    size_t i;
    if (size < count)
        return ERROR;
    for (i = 0; i < count; i++) {
        if (references[i] != MODEL_VALID)
            return ERROR;
        values[i] = model_is_valid(model) != 0;
    }
    return OK;
}

/* What is refused unless it is asked of no variable; behind its name, the arguments behind references and count. */
#define NOTHING(NAME, ...)                                                                                             \
    EXPORT int fmi3##NAME(Model *model, const Reference references[], size_t count, __VA_ARGS__)                       \
    {                                                                                                                  \
        return count ? ERROR : OK;                                                                                     \
    }
#define NO_INPUT_OF(NAME, TYPE) NOTHING(Set##NAME, const TYPE values[], size_t size)
#define NONE_OF(NAME, TYPE)                                                                                            \
    NOTHING(Get##NAME, TYPE values[], size_t size)                                                                     \
    NO_INPUT_OF(NAME, TYPE)

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
NOTHING(GetBinary, size_t sizes[], const uint8_t *values[], size_t size)
NOTHING(SetBinary, const size_t sizes[], const uint8_t *const values[], size_t size)
NOTHING(GetOutputDerivatives, const int32_t orders[], double values[], size_t size)

/* Clocks: there are none. */
NOTHING(GetClock, bool values[])
NOTHING(SetClock, const bool values[])
NOTHING(GetIntervalDecimal, double values[], int kinds[])
NOTHING(GetIntervalFraction, uint64_t counters[], uint64_t resolutions[], int kinds[])
NOTHING(GetShiftDecimal, double values[])
NOTHING(GetShiftFraction, uint64_t counters[], uint64_t resolutions[])
NOTHING(SetIntervalDecimal, const double values[])
NOTHING(SetIntervalFraction, const uint64_t counters[], const uint64_t resolutions[])
NOTHING(SetShiftDecimal, const double values[])
NOTHING(SetShiftFraction, const uint64_t counters[], const uint64_t resolutions[])
EXPORT int fmi3ActivateModelPartition(Model *model, Reference clock, double time) { return ERROR; }

/* Every output depends on every input. */
EXPORT int fmi3GetNumberOfVariableDependencies(Model *model, Reference reference, size_t *count)
{
    *count = reference >= MAP_INPUTS && reference <= MODEL_VALID ? MAP_INPUTS : 0;
    return OK;
}

EXPORT int fmi3GetVariableDependencies(Model *model, Reference dependent, size_t elements[], Reference independents[],
    size_t others[], int kinds[], size_t count)
{
    size_t i;
    if (dependent < MAP_INPUTS || dependent > MODEL_VALID || count > MAP_INPUTS)
        return ERROR;
    for (i = 0; i < count; i++) {
        elements[i] = others[i] = 0;
        independents[i] = (Reference)i;
        kinds[i] = DEPENDENT;
    }
    return OK;
}

EXPORT int fmi3GetDirectionalDerivative(Model *model, const Reference unknowns[], size_t unknown_count,
    const Reference knowns[], size_t known_count, const double seeds[], size_t seed_count, double values[],
    size_t value_count)
{
    if (seed_count < known_count || value_count < unknown_count)
        return ERROR;
    return slope_sums(model, unknowns, unknown_count, knowns, known_count, seeds, values, 0);
}

EXPORT int fmi3GetAdjointDerivative(Model *model, const Reference unknowns[], size_t unknown_count,
    const Reference knowns[], size_t known_count, const double seeds[], size_t seed_count, double values[],
    size_t value_count)
{
    if (seed_count < unknown_count || value_count < known_count)
        return ERROR;
    return slope_sums(model, unknowns, unknown_count, knowns, known_count, seeds, values, 1);
}

/* Model exchange, which the description does not offer: some importers look for these names in every unit. */
EXPORT int fmi3EnterContinuousTimeMode(Model *model) { return ERROR; }
EXPORT int fmi3CompletedIntegratorStep(Model *model, bool keeps, bool *event, bool *ends) { return ERROR; }
EXPORT int fmi3SetTime(Model *model, double time) { return ERROR; }

#define NO_STATES(NAME, TYPE)                                                                                          \
    EXPORT int fmi3##NAME(Model *model, TYPE values[], size_t count) { return ERROR; }

NO_STATES(SetContinuousStates, const double)
NO_STATES(GetContinuousStates, double)
NO_STATES(GetContinuousStateDerivatives, double)
NO_STATES(GetNominalsOfContinuousStates, double)
NO_STATES(GetEventIndicators, double)

#define NUMBER_OF(NAME)                                                                                                \
    EXPORT int fmi3GetNumberOf##NAME(Model *model, size_t *count)                                                      \
    {                                                                                                                  \
        *count = 0;                                                                                                    \
        return OK;                                                                                                     \
    }

NUMBER_OF(ContinuousStates)
NUMBER_OF(EventIndicators)

EXPORT int fmi3DoStep(Model *model, double time, double step, bool keeps, bool *event, bool *ends, bool *early, double *last)
{
    model->time = time + step;
    *event = *ends = *early = false;
    *last = time + step;
    return OK;
}
