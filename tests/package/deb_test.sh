#!/usr/bin/env bash
# Makes the Debian packages as docs/packaging.md says and installs them in a root that holds nothing else: the program runs there, a
# host is compiled and runs there, and removing them leaves nothing behind. Takes minutes; needs root and Debian's packages.
#
#   deb_test.sh SOURCE WORK [cmake options ...]
#
# Exit code: 0 passed, 1 failed; "SKIPPED: why" where a tool, root or the packages are missing.
source=$(cd "$1" && pwd) || exit 1
mkdir -p "$2" || exit 1
work=$(cd "$2" && pwd) || exit 1
shift 2

skip() {
    echo "SKIPPED: $*"
    exit 0
}
fail() {
    echo "deb_test: $*" >&2
    exit 1
}
for tool in cpack dpkg-deb dpkg-shlibdeps mmdebstrap; do
    command -v "$tool" >/dev/null || skip "$tool is not installed (dpkg-dev, mmdebstrap)"
done
[ "$(id -u)" -eq 0 ] || skip "a new root needs root"

# --- make them ----------------------------------------------------------------------------------------
build=$work/build
(cd "$source" && cmake --preset package -B "$build" "$@" && cmake --build "$build" --parallel "$(nproc)") >"$work/build.txt" 2>&1 ||
    { tail -n 30 "$work/build.txt" >&2; fail "the build failed"; }
rm -f "$build"/*.deb
(cd "$build" && cpack) >"$work/cpack.txt" 2>&1 || { cat "$work/cpack.txt" >&2; fail "cpack failed"; }

# --- what they say ------------------------------------------------------------------------------------
abi=$(sed -n 's/^set(LIGHTWELL_ABI \([0-9]*\))$/\1/p' "$source/CMakeLists.txt")
runtime=("$build/liblightwell${abi}"_*.deb) dev=("$build"/liblightwell-dev_*.deb) tools=("$build"/lightwell-tools_*.deb)
for package in "${runtime[0]}" "${dev[0]}" "${tools[0]}"; do
    [ -f "$package" ] || fail "expected $package"
    dpkg-deb -c "$package" | grep >/dev/null '/usr/share/doc/.*/copyright$' || fail "$package: expected its licence"
done
expect_field() { # PACKAGE FIELD PATTERN
    dpkg-deb -f "$1" "$2" | grep -E "$3" >/dev/null || fail "$(basename "$1"), $2: expected $3, got $(dpkg-deb -f "$1" "$2")"
}
expect_field "${runtime[0]}" Depends 'libopencl1'
expect_field "${runtime[0]}" Depends 'libc6 \(>= '
expect_field "${dev[0]}" Depends "^liblightwell${abi} \\(= "
expect_field "${tools[0]}" Depends "liblightwell${abi} \\(= .*libembree"
dpkg-deb -I "${runtime[0]}" shlibs | grep >/dev/null "^liblightwell ${abi} liblightwell${abi} (>= " || fail "expected shlibs of ABI ${abi}"
dpkg-deb -I "${runtime[0]}" postinst | grep >/dev/null ldconfig || fail "expected the runtime package to have ldconfig run"

# --- in a clean root ----------------------------------------------------------------------------------
cat >"$work/inside.sh" <<'INSIDE'
set -e
export LC_ALL=C DEBIAN_FRONTEND=noninteractive LIGHTWELL_DEVICE=cpu
cd /lightwell
apt-get install -y --no-install-recommends ./liblightwell[0-9]*.deb ./lightwell-tools_*.deb pocl-opencl-icd
lightwell --version
lightwell scenes | grep '^cornell .*shipped  */usr/share/lightwell/scenes/'
lightwell devices
lightwell render cornell --technique rsm --size 64x64 --frames 1 --warmup 0 --out picture.png --hash
test -s picture.png
test -s /usr/share/man/man1/lightwell.1.gz
test "$(lightwell complete render --technique rs)" != ""
ldconfig -p | grep liblightwell.so.
apt-get install -y --no-install-recommends ./liblightwell-dev_*.deb gcc libc6-dev pkg-config
gcc -std=c11 minimal.c -o minimal $(pkg-config --cflags --libs lightwell)
./minimal
apt-get purge -y lightwell-tools 'liblightwell*'
rm -rf /root/.cache /lightwell
find / -xdev -name '*lightwell*' -not -path '/proc/*' -not -path '/sys/*' -not -path '/var/log/*' -not -path '/var/lib/apt/*' >/left
test ! -s /left || { cat /left; exit 1; }
echo "all is well inside"
INSIDE
rm -rf "$work/given"
mkdir "$work/given" || exit 1
cp "${runtime[0]}" "${dev[0]}" "${tools[0]}" "$work/inside.sh" "$source/samples/minimal.c" "$work/given/" || exit 1
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-bookworm}")
mmdebstrap --variant=apt --customize-hook="copy-in $work/given /" --customize-hook='mv "$1/given" "$1/lightwell"' \
    --customize-hook='chroot "$1" sh /lightwell/inside.sh' --format=null "$suite" /dev/null >"$work/inside.txt" 2>&1
status=$?
if [ $status -ne 0 ]; then
    grep -q 'customize-hook\|lightwell --version' "$work/inside.txt" || { tail -n 5 "$work/inside.txt"; skip "no new root can be made here"; }
    tail -n 40 "$work/inside.txt" >&2
    fail "in the clean root, see $work/inside.txt"
fi
grep -q 'all is well inside' "$work/inside.txt" || fail "the root's own steps did not run, see $work/inside.txt"
grep -E '^[0-9]+\.[0-9]+\.[0-9]+$|the floor receives|^cornell|^[0-9]+  ' "$work/inside.txt"
echo "packages made, installed, used and removed"
