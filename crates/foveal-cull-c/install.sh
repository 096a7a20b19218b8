#!/usr/bin/env bash
# Builds the C library and installs libraries, headers, CMake's find_package and pkg-config files.
#
#   install.sh PREFIX            builds with cargo, in release
#   install.sh PREFIX --from DIR takes libraries that are built already
set -euo pipefail

fail() {
    printf '%s\n' "$*" >&2
    exit 1
}

here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
prefix="${1:-}"
[ -n "$prefix" ] || fail "usage: install.sh PREFIX [--from DIR]"
version="$(sed -n 's/^#define FOVEAL_CULL_VERSION 0x\([0-9a-f]\{8\}\)u$/\1/p' "$here/include/foveal_cull.h")"
[ -n "$version" ] || fail "foveal_cull.h names no version"
major=$((0x$version >> 24)) minor=$((0x$version >> 12 & 0xfff)) patch=$((0x$version & 0xfff))
version="$major.$minor.$patch"
# The numbers after which programs must be linked anew.
series="$major"
[ "$major" != 0 ] || series="0.$minor"

case "$(uname -s)" in
Linux) shared=libfoveal_cull_c.so links=("$shared.$series") native="-lpthread -ldl -lm -lrt" ;;
Darwin) shared=libfoveal_cull_c.dylib links=("libfoveal_cull_c.$series.dylib") native="-lm" ;;
*) fail "this script installs on Linux and macOS. Elsewhere: cargo build --release --package foveal-cull-c" ;;
esac

if [ "${2:-}" = --from ]; then
    from="${3:?--from needs a folder}"
else
    [ $# = 1 ] || fail "usage: install.sh PREFIX [--from DIR]"
    cargo build --release --locked --manifest-path "$here/Cargo.toml"
    from="$(cargo metadata --no-deps --format-version 1 --manifest-path "$here/Cargo.toml" |
        sed 's/.*"target_directory":"\([^"]*\)".*/\1/')/release"
fi
for library in "$shared" libfoveal_cull_c.a; do
    [ -f "$from/$library" ] || fail "$from has no $library"
done

fill() {
    local list="${native//-l/}"
    sed -e "s|@VERSION@|$version|g" -e "s|@SERIES@|$major.$minor|g" -e "s|@SHARED@|$shared|g" \
        -e "s|@NATIVE_LIST@|${list// /;}|g" -e "s|@NATIVE@|$native|g" "$here/install/$1.in" >"$2/$1"
    chmod 644 "$2/$1"
}

mkdir -p "$prefix/include" "$prefix/lib/cmake/foveal_cull" "$prefix/lib/pkgconfig"
install -m 644 "$here"/include/* "$prefix/include"
install -m 644 "$from/libfoveal_cull_c.a" "$prefix/lib"
install -m 755 "$from/$shared" "$prefix/lib/${links[0]}"
ln -sf "${links[0]}" "$prefix/lib/$shared"
fill foveal_cullConfig.cmake "$prefix/lib/cmake/foveal_cull"
fill foveal_cullConfigVersion.cmake "$prefix/lib/cmake/foveal_cull"
fill foveal_cull.pc "$prefix/lib/pkgconfig"
printf 'foveal-cull %s is installed in %s\n' "$version" "$prefix"
