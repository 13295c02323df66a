# Sourced by the other scripts: the virtual environment, the package, a Vulkan adapter.
# Everything lands in .venv of the checkout, except system packages, which come by apt.

cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '\033[1m==>\033[0m %s\n' "$*" >&2; }
fail() { printf 'scuro: %s\n' "$*" >&2; exit 1; }

# Run a command as root: directly, through sudo where it asks for no password, or not at all.
as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"
  elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then sudo "$@"
  else return 1
  fi
}

# apt_install PACKAGE…: install by apt where there is apt and we may; returns non-zero otherwise.
apt_install() {
  command -v apt-get >/dev/null || return 1
  if [ -z "${apt_updated:-}" ]; then
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -qq >/dev/null 2>&1 || return 1
    apt_updated=1
  fi
  as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -qq --no-install-recommends "$@" >/dev/null 2>&1
}

find_python() {
  local candidate
  for candidate in ${PYTHON:-} python3 python3.13 python3.12 python3.11 python3.14; do
    if "$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
      echo "$candidate"
      return
    fi
  done
  fail "Python 3.11 or newer is needed: apt-get install python3 python3-venv, or set PYTHON=/path/to/python3"
}

# make_venv: .venv with the newest suitable Python; on Debian the venv module is a package apart.
make_venv() {
  [ -x .venv/bin/python ] && .venv/bin/python -m pip --version >/dev/null 2>&1 && return
  local python
  python=$(find_python) || exit 1
  say "making a virtual environment in .venv ($("$python" --version))"
  rm -rf .venv
  if ! "$python" -m venv .venv >/dev/null 2>&1; then
    rm -rf .venv
    local version
    version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    apt_install "python$version-venv" || apt_install python3-venv || true
    "$python" -m venv .venv ||
      fail "cannot make a virtual environment: as root, apt-get install python3-venv, then run this again"
  fi
}

# install_package EXTRAS: this checkout, editable, with the given extras ("" for none).
install_package() {
  say "installing scuro${1:+ with its extras $1} (the first time takes a minute or two)"
  .venv/bin/python -m pip install --quiet --disable-pip-version-check --editable ".${1:+[$1]}" ||
    fail "pip could not install scuro: see its message above; a network or a package index is needed"
}

has_adapter() {
  .venv/bin/python -c 'import sys; from scuro.gpu.device import list_adapters; sys.exit(not list_adapters())' 2>/dev/null
}

# ensure_adapter: any GPU will do; without one, Mesa's software Vulkan driver (lavapipe).
ensure_adapter() {
  has_adapter && return
  say "no GPU adapter found: installing Mesa's software Vulkan driver"
  apt_install mesa-vulkan-drivers libvulkan1 || true
  has_adapter ||
    fail "no Vulkan adapter: as root, run 'apt-get install mesa-vulkan-drivers libvulkan1' (Debian, Ubuntu) or install your GPU's Vulkan driver, then run this again"
}
