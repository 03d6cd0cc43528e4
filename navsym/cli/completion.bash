# completion of navsym for bash
_navsym() {
    local line="${COMP_LINE:0:COMP_POINT}" word prefix
    local last="${line##*[[:space:]]}"
    COMPREPLY=()
    prefix=""
    if [[ "$last" == *:* && "$COMP_WORDBREAKS" == *:* ]]; then prefix="${last%"${last##*:}"}"; fi
    while IFS= read -r word; do COMPREPLY+=("${word#"$prefix"}"); done < <(navsym completion words "$line" 2>/dev/null)
}
complete -o default -F _navsym navsym
