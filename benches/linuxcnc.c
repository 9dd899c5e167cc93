/* Times the trajectory planner of an installed LinuxCNC, called as its motion controller calls it.

   linuxcnc-planner MODULE FEED ACCELERATION TOLERANCE RAPID [places] < PLACES

   Feed and rapid in mm/s, the acceleration of each axis in mm/s2, the tolerance of G64 in mm; on each line of PLACES
   an X and a Z in mm, the first of them where it stands. Prints nanoseconds of processor time an added segment and a
   cycle of 1 ms, and seconds of machine time; with `places` before that X and Z of every cycle, a line each.

   The planner is the package's own module, loaded when this runs; its types come from the headers of
   linuxcnc-uspace-dev. Nothing of it is here, and this is no part of the product. */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "motion.h"
#include "motion_types.h"
#include "tp.h"

/* What the module wants of the rest of LinuxCNC. */
int hal_init(const char *name) { (void)name; return 1; }
int hal_ready(int id) { (void)id; return 0; }
int hal_exit(int id) { (void)id; return 0; }
void rtapi_print(const char *format, ...) { (void)format; }
void rtapi_print_msg(int level, const char *format, ...) { (void)level; (void)format; }

static double rapid, acceleration;

static void digital(int index, char value) { (void)index; (void)value; }
static void analog(int index, double value) { (void)index; (void)value; }
static void unlock(int joint, int on) { (void)joint; (void)on; }
static int is_unlocked(int joint) { (void)joint; return 1; }
/* Of X, Y and Z; there is no Y. */
static double axis_speed(int axis) { return axis == 0 || axis == 2 ? rapid : 0.0; }
static double axis_acceleration(int axis) { return axis == 0 || axis == 2 ? acceleration : 0.0; }

static double now_ns(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time.tv_sec * 1e9 + time.tv_nsec;
}

static void *known(void *module, const char *name)
{
    void *function = dlsym(module, name);
    if (!function) {
        fprintf(stderr, "%s\n", dlerror());
        exit(1);
    }
    return function;
}

int main(int count, char **words)
{
    enum { PLACES_MAX = 1 << 20, CYCLES_MAX = 1 << 24 };
    static emcmot_status_t status;
    static emcmot_config_t config;
    static TP_STRUCT planner;
    int tells = count == 7;
    if (count != 6 && !tells) {
        fprintf(stderr, "usage: linuxcnc-planner MODULE FEED ACCELERATION TOLERANCE RAPID [places] < PLACES\n");
        return 1;
    }
    void *module = dlopen(words[1], RTLD_NOW);
    if (!module) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    double feed = atof(words[2]), tolerance = atof(words[4]);
    acceleration = atof(words[3]);
    rapid = atof(words[5]);

    double *x = malloc(PLACES_MAX * sizeof *x), *z = malloc(PLACES_MAX * sizeof *z);
    int places = 0;
    while (places < PLACES_MAX && scanf("%lf %lf", &x[places], &z[places]) == 2)
        places++;

    /* The names of the functions are taken for the types of their pointers. */
#define FUNCTION(name) __typeof__(name) *call_##name = known(module, #name)
    FUNCTION(tpMotFunctions);
    FUNCTION(tpMotData);
    FUNCTION(tpCreate);
    FUNCTION(tpSetCycleTime);
    FUNCTION(tpSetVmax);
    FUNCTION(tpSetVlimit);
    FUNCTION(tpSetAmax);
    FUNCTION(tpSetPos);
    FUNCTION(tpSetTermCond);
    FUNCTION(tpAddLine);
    FUNCTION(tpRunCycle);
    FUNCTION(tpIsDone);
    FUNCTION(tpGetPos);
    FUNCTION(tcqFull);

    /* As its sample machines have it. */
    status.net_feed_scale = status.feed_scale = status.rapid_scale = 1.0;
    config.trajCycleTime = config.servoCycleTime = 0.001;
    config.arcBlendEnable = 1;
    config.arcBlendFallbackEnable = 0;
    config.arcBlendOptDepth = 50;
    config.arcBlendGapCycles = 4;
    config.arcBlendRampFreq = 100.0;
    config.arcBlendTangentKinkRatio = 0.1;
    config.maxFeedScale = 1.0;
    config.limitVel = rapid;
    call_tpMotFunctions(digital, analog, unlock, is_unlocked, axis_speed, axis_acceleration);
    call_tpMotData(&status, &config);
    EmcPose pose = {0};
    pose.tran.x = x[0];
    pose.tran.z = z[0];
    call_tpCreate(&planner, DEFAULT_TC_QUEUE_SIZE, 1);
    call_tpSetCycleTime(&planner, 0.001);
    call_tpSetVmax(&planner, rapid, rapid);
    call_tpSetVlimit(&planner, rapid);
    call_tpSetAmax(&planner, acceleration);
    call_tpSetPos(&planner, &pose);
    call_tpSetTermCond(&planner, TC_TERM_COND_PARABOLIC, tolerance);

    double adding_ns = 0, running_ns = 0;
    int next = 1, cycle = 0;
    struct state_tag_t tag = {0};
    while (next < places || !call_tpIsDone(&planner)) {
        /* As full as it gets, then a few dozen cycles: the clock is looked at seldom. */
        double began = now_ns();
        while (next < places && !call_tcqFull(&planner.queue)) {
            double dx = x[next] - x[next - 1], dz = z[next] - z[next - 1], way = hypot(dx, dz);
            /* Along a line each axis has all of its limit. */
            double longest = fmax(fabs(dx), fabs(dz));
            pose.tran.x = x[next];
            pose.tran.z = z[next];
            int fault = call_tpAddLine(&planner, pose, EMC_MOTION_TYPE_FEED, feed, rapid * way / longest,
                acceleration * way / longest, FS_ENABLED, 0, -1, tag);
            if (fault < 0) {
                fprintf(stderr, "tpAddLine: %d at segment %d\n", fault, next);
                return 1;
            }
            next++;
        }
        double added = now_ns();
        adding_ns += added - began;
        for (int turn = 0; turn < 64 && cycle < CYCLES_MAX && !call_tpIsDone(&planner); turn++) {
            call_tpRunCycle(&planner, 1000000);
            if (tells) {
                call_tpGetPos(&planner, &pose);
                printf("%.9f %.9f\n", pose.tran.x, pose.tran.z);
            }
            cycle++;
        }
        running_ns += now_ns() - added;
        if (cycle == CYCLES_MAX) {
            fprintf(stderr, "it never ends\n");
            return 1;
        }
    }
    call_tpGetPos(&planner, &pose);
    if (hypot(pose.tran.x - x[places - 1], pose.tran.z - z[places - 1]) > 1e-6) {
        fprintf(stderr, "it ends at X%.6f Z%.6f\n", pose.tran.x, pose.tran.z);
        return 1;
    }
    printf("%.1f %.1f %.4f\n", adding_ns / (places - 1), running_ns / cycle, cycle * 0.001);
    return 0;
}
