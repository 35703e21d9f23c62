#!/bin/sh
# What became of a job of Slurm: success, running or failed.
state=$(scontrol --oneliner show job "$1" 2>/dev/null | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p')
# Some minutes after its end only the accounts know it, where a cluster keeps them.
[ -n "$state" ] || state=$(sacct -X -n -P -o State -j "$1" 2>/dev/null | head -n 1 | cut -d ' ' -f 1)
# The controller may be away for a moment.
[ -n "$state" ] || scontrol ping >/dev/null 2>&1 || state=PENDING
case $state in
COMPLETED) echo success ;;
PENDING | CONFIGURING | RUNNING | COMPLETING | STOPPED | SUSPENDED | RESIZING | REQUEUED | REQUEUE_HOLD | SIGNALING | STAGE_OUT) echo running ;;
*) echo failed ;;
esac
