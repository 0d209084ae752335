# shellcheck shell=bash disable=SC2154 # suite and fresh are of scripts/setup
# The browser of scripts/setup --browser. Sourced by scripts/setup alone, whose functions it uses.

browser_packages=(chromium-headless-shell fonts-dejavu-core fonts-dejavu-mono)
# Of npm's registry: the version and the SHA-512 of its archive, which is the registry's own "integrity" in another base.
axe_version=4.14.1
axe_sha512=1477dafa598d8d065f273d6af302aa203c02e83131707b7fa648cd41bd3d6b734f8c22a0dab86ee6a6f64b8afbe804b214d36db85a2826965edfb3a0b9d546b5

# Chromium that draws into memory only, its driver, fonts, and axe-core, which tells what hinders people on a page. Two
# programs there start them: chromium and chromedriver.
browser() {
    local folder=$browser_root wanted="1 $suite ${browser_packages[*]} axe-core-$axe_version" reason
    if [[ $(cat "$folder/.complete" 2>/dev/null) == "$wanted" ]]; then
        say "browser: $folder is up to date"
        return
    fi
    if reason=$(cannot_unpack); then
        fail "the browser is unpacked from Debian 13, and $reason" "without it the tests in tests/browser are skipped"
    fi
    # Replace only what an earlier run made.
    [[ ! -e $folder || -e $folder/packages.txt ]] || fail "$folder exists and was not made by this script" \
        "move it away, or choose another folder: GAITWAY_BROWSER_ROOT=..."
    mkdir -p "$(dirname "$folder")"
    open_apt
    fresh=$(mktemp -d "$folder.new.XXXXXX")
    axe_core "$fresh"
    unpack_chromium "$fresh"
    rm -rf "$folder"
    mv "$fresh" "$folder"
    try_browser
    echo "$wanted" >"$folder/.complete"
    say "browser: $folder is ready ($(du -sh "$folder" | cut -f 1)): $("$folder/chromedriver" --version | cut -d ' ' -f 1-2)," \
        "axe-core $axe_version"
}

unpack_chromium() {
    local fresh=$1 library=$browser_root/usr/lib program loader
    unpack "$fresh" "${browser_packages[@]}"
    # The driver depends on a Chromium with windows; its libraries are those of the one without.
    (cd "$apt_folder/archives" && private_apt download chromium-driver) || fail "apt could not fetch chromium-driver" "its words are above"
    dpkg-deb -x "$apt_folder"/archives/chromium-driver_*.deb "$fresh" || fail "could not unpack chromium-driver: is the disk full?"
    # Nothing draws on a device: without Mesa and LLVM a third of the size goes.
    rm -rf "$fresh/usr/lib/$triplet"/{libLLVM*,libz3*,libgallium*,dri,gbm} "$fresh"/usr/lib/chromium/libVk*
    find "$fresh/usr/share" -mindepth 1 -maxdepth 1 ! -name fonts -exec rm -rf {} +
    find "$fresh/usr/bin" -type f ! -name chromedriver -delete
    # Chromium looks for its files beside the program that the system names, and that is the loader.
    loader=$(first_of "$fresh/usr/lib/$triplet"/ld-linux-*.so.[0-9]) || fail "no dynamic loader among Debian's packages"
    cp -L "$loader" "$fresh/usr/lib/chromium/loader"
    fonts_of_browser >"$fresh/fonts.conf"
    # A process of Chromium begins the others with the program that it is told to, unless a process without program does it.
    for program in chromium chromedriver; do
        {
            printf '#!/bin/sh\nexport FONTCONFIG_FILE="%s"\n' "$browser_root/fonts.conf"
            printf 'exec "%s" --library-path "%s" ' "$library/chromium/loader" "$library/$triplet:$library/$triplet/pulseaudio"
            if [[ $program == chromium ]]; then
                printf '"%s" --no-zygote --browser-subprocess-path="%s" "$@"\n' \
                    "$library/chromium/chromium-headless-shell" "$browser_root/chromium"
            else
                printf '"%s" "$@"\n' "$browser_root/usr/bin/chromedriver"
            fi
        } >"$fresh/$program"
        chmod 755 "$fresh/$program"
    done
    chmod 755 "$fresh"
}

# The same letters on every machine: its own fonts do not count.
fonts_of_browser() {
    local generic
    printf '<?xml version="1.0"?>\n<!DOCTYPE fontconfig SYSTEM "fonts.dtd">\n<fontconfig>\n'
    printf '  <dir>%s</dir>\n  <cachedir>%s</cachedir>\n' "$browser_root/usr/share/fonts" "$browser_root/fonts"
    for generic in 'sans-serif:DejaVu Sans' 'system-ui:DejaVu Sans' 'serif:DejaVu Serif' 'monospace:DejaVu Sans Mono'; do
        printf '  <alias><family>%s</family><prefer><family>%s</family></prefer></alias>\n' "${generic%%:*}" "${generic#*:}"
    done
    printf '</fontconfig>\n'
}

# axe_core FOLDER: the script alone. It is under the MPL 2.0, which its first lines say, and is never shipped.
axe_core() {
    local archive=$apt_folder/axe-core.tgz address=https://registry.npmjs.org/axe-core/-/axe-core-$axe_version.tgz reason
    have curl || ! can_install || apt_install curl || true
    have curl || fail "axe-core is fetched with curl, and there is none" 'Debian/Ubuntu: apt install curl'
    reason=$(curl --silent --show-error --fail --location --retry 1 --max-time 60 --output "$archive" "$address" 2>&1) ||
        fail "curl could not fetch $address" "$reason"
    sha512sum --check --status <<<"$axe_sha512  $archive" || fail "$address is not the archive that was looked at" \
        "SHA-512 wanted: $axe_sha512" "SHA-512 found:  $(sha512sum <"$archive" | cut -d ' ' -f 1)"
    tar -xzf "$archive" -C "$1" --strip-components 1 package/axe.min.js || fail "could not unpack axe-core: is the disk full?"
}

# One page is drawn before the browser counts as ready.
try_browser() {
    local page found
    page=$(mktemp -d "$browser_root/page.XXXXXX")
    found=$(timeout 60 "$browser_root/chromium" --headless --no-sandbox --disable-gpu --user-data-dir="$page" \
        --dump-dom 'data:text/html,<script>document.write(6*7)</script>' 2>&1) || true
    rm -rf "$page"
    if [[ $found != *'<body>42</body>'* ]] || ! "$browser_root/chromedriver" --version >/dev/null; then
        rm -rf "$browser_root.broken"
        mv "$browser_root" "$browser_root.broken"
        fail "the unpacked browser does not start; it is kept in $browser_root.broken" "${found##*$'\n'}"
    fi
}
