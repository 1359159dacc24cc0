// Walks input integers of one rule base: the firmware's engines beside an exact reference.
//
// Compiled with a model (model.h, defined in generated text) and with the undefined-behaviour
// sanitizer, so that it stops where an engine overflows, shifts or divides out of range. The
// reference computes in double from the rule file's own numbers, not from the table's integers:
// piecewise linear memberships, strengths, and for a centroid the area under the aggregated
// function, cut at every corner that it can have.
//
// usage: walk FROM TO      points of input 0, first and one past the last; all others whole
//        walk samples      every cell of the piecewise form (see sample_axis)
// Prints one JSON object; progress, points done, to stderr.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

enum { AXIS_MAX_TABLED = 1 << 18, CORNERS_MAX = 512 };

typedef struct {
    double worst;
    double at_value;
    double at_reference;
    int64_t at[FUZZY_MAX_INPUTS];
    int32_t least;
    int32_t most;
    uint64_t defaults;
    uint64_t default_differs;
    int64_t differs_at[FUZZY_MAX_INPUTS];
} output_result_t;

static output_result_t results[FUZZY_MAX_OUTPUTS];
static uint64_t points_done;
static uint64_t engines_differ;
static int64_t engines_differ_at[FUZZY_MAX_INPUTS];

// ---- reference ----------------------------------------------------------------------------------

static double larger(double a, double b) {
    return a > b ? a : b;
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

static double membership(const model_set_t *set, double x) {
    const model_point_t *p = set->points;
    const int n = set->count;
    if (x < p[0].x) {
        return p[0].mu;
    }
    if (x > p[n - 1].x) {
        return p[n - 1].mu;
    }
    double mu = -1.0;
    for (int i = 0; i < n; i++) {
        if (p[i].x == x && p[i].mu > mu) {
            mu = p[i].mu;
        }
    }
    for (int i = 1; mu < 0.0; i++) {
        if (p[i].x > x) {
            mu = p[i - 1].mu + (p[i].mu - p[i - 1].mu) * (x - p[i - 1].x) / (p[i].x - p[i - 1].x);
        }
    }
    return mu;
}

// An integer that stands on a breakpoint may miss it in double.
static double at_breakpoint(int i, double x) {
    const model_input_t *input = &model_inputs[i];
    const double near = 1e-12 * (input->maximum - input->minimum);
    for (int s = 0; s < input->sets; s++) {
        for (int k = 0; k < input->set[s].count; k++) {
            if (fabs(x - input->set[s].points[k].x) < near) {
                return input->set[s].points[k].x;
            }
        }
    }
    return x;
}

static double input_value(int i, int64_t n) {
    const double x =
        ((double)n * model_inputs[i].lsb_up) / model_inputs[i].lsb_down + model_inputs[i].origin;
    return at_breakpoint(i, smaller(larger(x, model_inputs[i].minimum), model_inputs[i].maximum));
}

static double *tabled[FUZZY_MAX_INPUTS]; // memberships of all points where they are few

static void make_table(int i) {
    const int64_t count = model_inputs[i].last - model_inputs[i].first + 1;
    if (count > AXIS_MAX_TABLED) {
        return;
    }
    tabled[i] = malloc((size_t)count * FUZZY_MAX_SETS * sizeof(double));
    for (int64_t k = 0; tabled[i] != NULL && k < count; k++) {
        const double x = input_value(i, model_inputs[i].first + k);
        for (int s = 0; s < model_inputs[i].sets; s++) {
            tabled[i][k * FUZZY_MAX_SETS + s] = membership(&model_inputs[i].set[s], x);
        }
    }
}

static void find_memberships(int i, int64_t n, double *mu) {
    const int64_t k = n - model_inputs[i].first;
    const bool is_tabled = tabled[i] != NULL && k >= 0 && n <= model_inputs[i].last;
    if (is_tabled) {
        memcpy(mu, &tabled[i][k * FUZZY_MAX_SETS], FUZZY_MAX_SETS * sizeof(double));
        return;
    }
    const double x = input_value(i, n);
    for (int s = 0; s < model_inputs[i].sets; s++) {
        mu[s] = membership(&model_inputs[i].set[s], x);
    }
}

// Rules that the inputs before the last do not forbid.
static int possible[MODEL_RULES];
static int possible_count;

static void find_possible(double mu[][FUZZY_MAX_SETS]) {
    possible_count = 0;
    for (int r = 0; r < MODEL_RULES; r++) {
        bool is_possible = true;
        for (int k = 0; k < model_rules[r].count && !model_rules[r].is_or; k++) {
            const model_condition_t c = model_rules[r].condition[k];
            const double here = c.negated ? 1.0 - mu[c.input][c.set] : mu[c.input][c.set];
            is_possible = is_possible && (c.input == MODEL_INPUTS - 1 || here > 0.0);
        }
        if (is_possible) {
            possible[possible_count++] = r;
        }
    }
}

static double strength_of(const model_rule_t *rule, double mu[][FUZZY_MAX_SETS]) {
    double strength = rule->is_or ? 0.0 : 1.0;
    for (int k = 0; k < rule->count; k++) {
        const model_condition_t c = rule->condition[k];
        const double here = c.negated ? 1.0 - mu[c.input][c.set] : mu[c.input][c.set];
        strength = rule->is_or ? larger(strength, here) : smaller(strength, here);
    }
    return strength * rule->weight;
}

// Between two neighbouring breakpoints of an output every set is a straight line.
typedef struct {
    double left, right; // memberships at the ends of the interval
} line_t;

static line_t *lines[FUZZY_MAX_OUTPUTS]; // of interval k and term t at k * terms + t

static void make_lines(int o) {
    const model_output_t *output = &model_outputs[o];
    if (output->method != FUZZY_CENTROID) {
        return;
    }
    lines[o] = malloc((size_t)(output->breakpoints * output->terms) * sizeof(line_t));
    for (int k = 0; lines[o] != NULL && k + 1 < output->breakpoints; k++) {
        const double x0 = output->breakpoint[k];
        const double width = output->breakpoint[k + 1] - x0;
        for (int t = 0; t < output->terms; t++) {
            // Inside the interval, so that an edge at its end does not count.
            const double near = membership(&output->set[t], x0 + width * 0.25);
            const double far = membership(&output->set[t], x0 + width * 0.75);
            const double half = (far - near) * 0.5;
            lines[o][k * output->terms + t] = (line_t){near - half, far + half};
        }
    }
}

// The lines of one interval whose terms are active, and where their clipped maximum may bend, as
// shares of the interval.
typedef struct {
    line_t line[FUZZY_MAX_SETS];
    double alpha[FUZZY_MAX_SETS];
    int lines;
    double bend[CORNERS_MAX];
    int bends;
} stretch_t;

static void add_bend(stretch_t *s, double left, double right) {
    if (left * right < 0.0 && s->bends < CORNERS_MAX) {
        const double at = left / (left - right);
        int k = s->bends++;
        while (k > 0 && s->bend[k - 1] > at) {
            s->bend[k] = s->bend[k - 1];
            k--;
        }
        s->bend[k] = at;
    }
}

static void find_bends(stretch_t *s) {
    s->bend[0] = 0.0;
    s->bend[1] = 1.0;
    s->bends = 2;
    for (int i = 0; i < s->lines; i++) {
        for (int j = 0; j < s->lines; j++) {
            add_bend(s, s->line[i].left - s->alpha[j], s->line[i].right - s->alpha[j]);
            if (j > i) {
                add_bend(s, s->line[i].left - s->line[j].left, s->line[i].right - s->line[j].right);
            }
        }
    }
}

static double aggregated(const stretch_t *s, double at) {
    double most = 0.0;
    for (int i = 0; i < s->lines; i++) {
        const double mu = s->line[i].left + (s->line[i].right - s->line[i].left) * at;
        most = larger(most, smaller(s->alpha[i], mu));
    }
    return most;
}

static double centroid(const model_output_t *output, int o, const double *alpha) {
    double area = 0.0;
    double moment = 0.0;
    for (int k = 0; k + 1 < output->breakpoints; k++) {
        stretch_t s;
        s.lines = 0;
        for (int t = 0; t < output->terms; t++) {
            const line_t line = lines[o][k * output->terms + t];
            if (alpha[t] > 0.0 && line.left + line.right > 0.0) {
                s.line[s.lines] = line;
                s.alpha[s.lines++] = alpha[t];
            }
        }
        if (s.lines == 0) {
            continue;
        }
        find_bends(&s);
        const double start = output->breakpoint[k];
        const double length = output->breakpoint[k + 1] - start;
        double y0 = aggregated(&s, 0.0);
        for (int c = 1; c < s.bends; c++) {
            const double x0 = start + length * s.bend[c - 1];
            const double x1 = start + length * s.bend[c];
            const double y1 = aggregated(&s, s.bend[c]);
            area += 0.5 * (x1 - x0) * (y0 + y1);
            moment += (x1 - x0) * (y0 * (2.0 * x0 + x1) + y1 * (x0 + 2.0 * x1)) / 6.0;
            y0 = y1;
        }
    }
    return moment / area;
}

// strength: of the possible rules.
static bool reference(const model_output_t *output, int o, const double *strength, double *value) {
    double alpha[FUZZY_MAX_TERMS];
    for (int t = 0; t < output->terms; t++) {
        alpha[t] = 0.0;
    }
    double sum = 0.0;
    double weighted = 0.0;
    for (int k = 0; k < possible_count; k++) {
        const int term = model_rules[possible[k]].conclusion[o];
        if (term < 0 || strength[k] == 0.0) {
            continue;
        }
        alpha[term] = larger(alpha[term], strength[k]);
        sum += strength[k];
        weighted += output->method == FUZZY_SUM ? strength[k] * output->singleton[term] : 0.0;
    }
    if (sum <= 0.0) {
        return false;
    }
    if (output->method == FUZZY_SUM) {
        *value = weighted / sum;
        return true;
    }
    if (output->method == FUZZY_CENTROID) {
        *value = centroid(output, o, alpha);
        return true;
    }
    sum = 0.0;
    for (int t = 0; t < output->terms; t++) {
        sum += alpha[t];
        weighted += alpha[t] * output->singleton[t];
    }
    *value = weighted / sum;
    return true;
}

// ---- comparison ---------------------------------------------------------------------------------

static void place(int64_t *to, const int32_t *n) {
    for (int i = 0; i < MODEL_INPUTS; i++) {
        to[i] = n[i];
    }
}

static void compare_engines(const int32_t *n, const int32_t *out, uint32_t defaults) {
#ifdef MODEL_STRAIGHT
    int32_t straight[FUZZY_MAX_OUTPUTS] = {0};
    const uint32_t mask = MODEL_STRAIGHT(n, straight);
    if (mask != defaults || memcmp(out, straight, MODEL_OUTPUTS * sizeof out[0]) != 0) {
        if (engines_differ++ == 0) {
            place(engines_differ_at, n);
        }
    }
#else
    (void)n;
    (void)out;
    (void)defaults;
#endif
}

static void compare_output(int o, const int32_t *n, int32_t out, bool is_default,
                           const double *strength) {
    const model_output_t *output = &model_outputs[o];
    output_result_t *result = &results[o];
    double expected = 0.0;
    const bool fires = reference(output, o, strength, &expected);
    result->defaults += is_default;
    if (fires == is_default) {
        if (result->default_differs++ == 0) {
            place(result->differs_at, n);
        }
        return;
    }
    if (is_default) {
        return;
    }
    result->least = out < result->least ? out : result->least;
    result->most = out > result->most ? out : result->most;
    const double value = (double)out * output->lsb_up / output->lsb_down + output->origin;
    const double error = fabs(value - expected);
    if (!(error <= result->worst)) {
        result->worst = error;
        result->at_value = value;
        result->at_reference = expected;
        place(result->at, n);
    }
}

static void visit(const int32_t *n, double mu[][FUZZY_MAX_SETS]) {
    double strength[MODEL_RULES];
    for (int k = 0; k < possible_count; k++) {
        strength[k] = strength_of(&model_rules[possible[k]], mu);
    }
    int32_t out[FUZZY_MAX_OUTPUTS] = {0};
    const uint32_t defaults = fuzzy_evaluate(model_table(), n, out);
    compare_engines(n, out, defaults);
    for (int o = 0; o < MODEL_OUTPUTS; o++) {
        compare_output(o, n, out[o], (defaults >> o & 1u) != 0, strength);
    }
    points_done++;
}

// ---- walks --------------------------------------------------------------------------------------

// An odometer over lists of integers, one list an input; a NULL list is a range.
typedef struct {
    const int64_t *list;
    int64_t first;
    int64_t count;
} wheel_t;

static int64_t value_at(const wheel_t *wheel, int64_t k) {
    return wheel->list != NULL ? wheel->list[k] : wheel->first + k;
}

static void walk(const wheel_t *wheels) {
    int64_t k[FUZZY_MAX_INPUTS] = {0};
    int32_t n[FUZZY_MAX_INPUTS] = {0};
    double mu[FUZZY_MAX_INPUTS][FUZZY_MAX_SETS] = {{0.0}};
    int changed = 0; // wheels from here on have moved
    for (;;) {
        for (int i = changed; i < MODEL_INPUTS; i++) {
            n[i] = (int32_t)value_at(&wheels[i], k[i]);
            find_memberships(i, n[i], mu[i]);
        }
        if (changed < MODEL_INPUTS - 1 || points_done == 0) {
            find_possible(mu);
        }
        visit(n, mu);
        int i = MODEL_INPUTS - 1;
        while (i >= 0 && ++k[i] == wheels[i].count) {
            k[i--] = 0;
        }
        if (i < 0) {
            return;
        }
        if (i == 0 || (points_done & 0xFFFFFF) == 0) {
            fprintf(stderr, "%llu\n", (unsigned long long)points_done);
        }
        changed = i;
    }
}

static void print_place(const char *name, const int64_t *at) {
    printf("\"%s\": [", name);
    for (int i = 0; i < MODEL_INPUTS; i++) {
        printf("%s%lld", i ? ", " : "", (long long)at[i]);
    }
    printf("]");
}

static void print_results(void) {
    printf("{\"points\": %llu, \"engines_differ\": %llu, ", (unsigned long long)points_done,
           (unsigned long long)engines_differ);
    print_place("engines_differ_at", engines_differ_at);
    printf(", \"outputs\": [");
    for (int o = 0; o < MODEL_OUTPUTS; o++) {
        const output_result_t *r = &results[o];
        printf("%s{\"worst\": %.17g, \"value\": %.17g, \"reference\": %.17g, ", o ? ", " : "",
               r->worst, r->at_value, r->at_reference);
        print_place("at", r->at);
        printf(", \"least\": %d, \"most\": %d, \"defaults\": %llu, \"default_differs\": %llu, ",
               r->least, r->most, (unsigned long long)r->defaults,
               (unsigned long long)r->default_differs);
        print_place("differs_at", r->differs_at);
        printf("}");
    }
    printf("]}\n");
}

int main(int argc, char **argv) {
    wheel_t wheels[FUZZY_MAX_INPUTS] = {{0}};
    const bool is_sampled = argc == 2 && strcmp(argv[1], "samples") == 0;
    if (!is_sampled && argc != 3) {
        fprintf(stderr, "walk FROM TO | walk samples\n");
        return 2;
    }
    for (int i = 0; i < MODEL_INPUTS; i++) {
        const model_input_t *input = &model_inputs[i];
        wheels[i] = is_sampled ? (wheel_t){input->samples, 0, input->sample_count}
                               : (wheel_t){NULL, input->first, input->last - input->first + 1};
        make_table(i);
    }
    if (!is_sampled) {
        wheels[0].first = atoll(argv[1]);
        wheels[0].count = atoll(argv[2]) - wheels[0].first;
    }
    for (int o = 0; o < MODEL_OUTPUTS; o++) {
        make_lines(o);
        results[o] = (output_result_t){.worst = -1.0, .least = INT32_MAX, .most = INT32_MIN};
    }
    walk(wheels);
    print_results();
    return 0;
}
