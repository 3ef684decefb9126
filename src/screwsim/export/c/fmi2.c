/* The model behind the functions of FMI 2.0 for co-simulation. */
#include "fmi.h"

EXPORT Text fmi2GetTypesPlatform(void) { return "default"; }
EXPORT Text fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetDebugLogging(Model *model, int on, size_t count, const Text categories[]) { return OK; }

EXPORT void *fmi2Instantiate(Text name, int type, Text guid, Text resources, const void *callbacks, int visible, int log)
{
    return type == 1 ? model_new(guid) : NULL; /* 1: co-simulation */
}

EXPORT int fmi2SetupExperiment(Model *model, int tolerant, double tolerance, double start, int stops, double stop)
{
    model->time = start;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(Model *model) { return model ? OK : ERROR; }
PLAIN_FUNCTIONS(fmi2)
STATE_FUNCTIONS(fmi2, FMUstate, DeSerializeFMUstate, char)

EXPORT int fmi2GetReal(Model *model, const Reference references[], size_t count, double values[])
{
    return read_numbers(model, references, count, values);
}

EXPORT int fmi2SetReal(Model *model, const Reference references[], size_t count, const double values[])
{
    return write_numbers(model, references, count, values);
}

EXPORT int fmi2GetBoolean(Model *model, const Reference references[], size_t count, int values[])
{
    size_t i;
    for (i = 0; i < count; i++) {
        if (references[i] != MODEL_VALID)
            return ERROR;
        values[i] = model_is_valid(model);
    }
    return OK;
}

/* There are no variables of other types, and no inputs that are not Real. */
#define NONE_OF(NAME, TYPE)                                                                                            \
    EXPORT int fmi2##NAME(Model *model, const Reference references[], size_t count, TYPE values[])                     \
    {                                                                                                                  \
        return count ? ERROR : OK;                                                                                     \
    }

NONE_OF(GetInteger, int)
NONE_OF(GetString, Text)
NONE_OF(SetInteger, const int)
NONE_OF(SetBoolean, const int)
NONE_OF(SetString, const Text)

EXPORT int fmi2GetDirectionalDerivative(Model *model, const Reference unknowns[], size_t unknown_count,
    const Reference knowns[], size_t known_count, const double seeds[], double values[])
{
    return slope_sums(model, unknowns, unknown_count, knowns, known_count, seeds, values, 0);
}

#define NO_DERIVATIVES(NAME, TYPE)                                                                                     \
    EXPORT int fmi2##NAME(Model *model, const Reference references[], size_t count, const int orders[], TYPE values[]) \
    {                                                                                                                  \
        return count ? ERROR : OK;                                                                                     \
    }

NO_DERIVATIVES(SetRealInputDerivatives, const double)
NO_DERIVATIVES(GetRealOutputDerivatives, double)

EXPORT int fmi2DoStep(Model *model, double time, double step, int keeps)
{
    model->time = time + step;
    return OK;
}

EXPORT int fmi2CancelStep(Model *model) { return ERROR; } /* no step is under way when this may be called */

/* A step is done when its call returns: nothing is pending that could be asked for. */
EXPORT int fmi2GetStatus(Model *model, int kind, int *value) { return DISCARD; }
EXPORT int fmi2GetIntegerStatus(Model *model, int kind, int *value) { return DISCARD; }
EXPORT int fmi2GetStringStatus(Model *model, int kind, Text *value) { return DISCARD; }

EXPORT int fmi2GetRealStatus(Model *model, int kind, double *value)
{
    if (kind != 2)
        return DISCARD;
    *value = model->time; /* the last time that was reached */
    return OK;
}

EXPORT int fmi2GetBooleanStatus(Model *model, int kind, int *value)
{
    if (kind != 3)
        return DISCARD;
    *value = 0; /* it does not ask for the end */
    return OK;
}
