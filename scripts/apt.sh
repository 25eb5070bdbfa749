#!/usr/bin/env bash
# scripts/apt.sh PACKAGE...: installs what is missing of these Debian packages where that is allowed,
# else says in one line what to install. Fails only if something is still missing.
set -u

missing=()
for package in "$@"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null)
  [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

if [ "$(id -u)" = 0 ]; then
  root=(env)
elif sudo --non-interactive true 2>/dev/null; then
  root=(sudo --non-interactive env)
else
  root=()
fi
if [ ${#root[@]} = 0 ] || ! command -v apt-get >/dev/null; then
  echo "please install the system packages (Debian's names): ${missing[*]}" >&2
  exit 1
fi

echo "setup: installing the system packages ${missing[*]}"
"${root[@]}" apt-get --quiet=2 update >/dev/null || echo "setup: apt-get update failed" >&2
failed=()
for package in "${missing[@]}"; do # one by one: a name that a release lacks must not stop the rest
  "${root[@]}" DEBIAN_FRONTEND=noninteractive \
    apt-get --quiet=2 install --yes --no-install-recommends "$package" >/dev/null </dev/null ||
    failed+=("$package")
done
[ ${#failed[@]} = 0 ] || { echo "could not install the system packages ${failed[*]}" >&2; exit 1; }
