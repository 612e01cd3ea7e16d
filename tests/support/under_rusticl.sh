#!/usr/bin/env bash
# Runs a suite on Mesa's Rusticl with its software rasteriser llvmpipe.
#   under_rusticl.sh SUITE [argument of Catch]...

vendor=
for folder in ${OCL_ICD_VENDORS:-} /etc/OpenCL/vendors; do
    [ -e "$folder/rusticl.icd" ] && vendor=$folder/rusticl.icd && break
done
if [ -z "$vendor" ]; then
    echo "SKIPPED: Rusticl is not installed (Debian: mesa-opencl-icd)"
    exit 0
fi
export RUSTICL_ENABLE=llvmpipe OCL_ICD_VENDORS=$vendor
unset LIGHTWELL_DEVICE
exec "$@" </dev/null
