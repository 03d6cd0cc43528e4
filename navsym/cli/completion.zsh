#compdef navsym
# completion of navsym for zsh
_navsym() {
    local -a found
    found=("${(@f)$(navsym completion words "${(j: :)words[1,CURRENT]}" 2>/dev/null)}")
    if [[ -n "${found[1]}" ]]; then compadd -- "${found[@]}"; else _files; fi
}
compdef _navsym navsym
