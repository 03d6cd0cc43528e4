(* Polynomials with coefficients >= 0 in variables >= 0: the rule `cones` of docs/certificates.md. *)

open Text
open Tree
open Algebra
open Goal

(* A polynomial in variables with numbers, and groups of variables that are not all 0 *)
type cone = { polynomial : form; groups : int list list }

let variable i = intern (Symbol (Printf.sprintf "#%d" i))
let form_of i = of_monomial [ (variable i, Q.one) ]

let rational_end t =
  match !constant t with Some q -> q | None -> refuse "cones: expected a rational end"

(* Numerator, denominator and group of symbol number k, for each choice of its sign *)
let substitutes n k r =
  let y = form_of k and z = form_of (n + k) and unit = form_of (2 * n) in
  let group is_open = if is_open then [ [ k ] ] else [] in
  match (Option.map rational_end r.low, Option.map rational_end r.high) with
  | Some low, Some high ->
      if Q.geq low high then refuse "cones: a range without inner points";
      [ (add (scale low z) (scale high y), add y z, [ [ k; n + k ] ]) ]
  | Some low, None -> [ (add (scale low unit) y, unit, group r.open_low) ]
  | None, Some high -> [ (add (scale high unit) (negative y), unit, group r.open_high) ]
  | None, None -> [ (y, unit, group r.nonzero); (negative y, unit, group r.nonzero) ]

let get_exponent (q : Q.t) =
  if is_whole q && Q.sign q > 0 then Z.to_int q.Q.num else refuse "cones: no polynomial"

(* The polynomial with numerator/denominator in the place of an atom, times denominator^degree *)
let substitute (p : form) atom (above, below, _) =
  let exponent m = match List.assoc_opt atom m with Some q -> get_exponent q | None -> 0 in
  let degree = Terms.fold (fun m _ d -> max d (exponent m)) p 0 in
  let one_term m c sum =
    let e = exponent m in
    let rest = Terms.singleton (List.filter (fun (i, _) -> i <> atom) m) c in
    let whole f k = whole_power f (Z.of_int k) in
    add sum (multiply rest (multiply (whole above e) (whole below (degree - e))))
  in
  Terms.fold one_term p nothing

let read_polynomial names t =
  let p = normal t in
  let is_known (i, q) =
    ignore (get_exponent q);
    match atom_of i with Symbol s -> List.mem s names | _ -> false
  in
  if not (Terms.for_all (fun m _ -> List.for_all is_known m) p) then refuse "cones: no polynomial";
  p

(* The polynomials of all choices of signs; the last symbol without ends changes first. *)
let cones_of goal =
  let names = Names.elements (symbols goal.tree) in
  let n = List.length names in
  if n > 8 then refuse "cones: more than 8 symbols";
  let start = { polynomial = read_polynomial names goal.tree; groups = [ [ 2 * n ] ] } in
  let replace_one cones (k, name) =
    let choices = substitutes n k (range_of goal name) in
    let atom = intern (Symbol name) in
    let choose cone ((_, _, group) as choice) =
      { polynomial = substitute cone.polynomial atom choice; groups = group @ cone.groups }
    in
    List.concat_map (fun cone -> List.map (choose cone) choices) cones
  in
  (2 * n, List.fold_left replace_one [ start ] (List.mapi (fun k name -> (k, name)) names))

(* Every set of variables that meets every group contains all variables of some term. *)
let is_positive cone =
  let terms = List.map (fun (m, _) -> List.map fst m) (key cone.polynomial) in
  let groups = List.map (List.map variable) cone.groups in
  let all = List.sort_uniq compare (List.concat (terms @ groups)) in
  if List.length all > 14 then refuse "cones: more than 14 variables";
  let number_of v = let rec go i = function w :: l -> if v = w then i else go (i + 1) l | [] -> assert false in go 0 all in
  let mask l = List.fold_left (fun s v -> s lor (1 lsl number_of v)) 0 l in
  let terms = List.map mask terms and groups = List.map mask groups in
  let holds set =
    (not (List.for_all (fun g -> g land set <> 0) groups)) || List.exists (fun t -> t land set = t) terms
  in
  let rec every set = set < 0 || (holds set && every (set - 1)) in
  every ((1 lsl List.length all) - 1)

let rec check_split relation last cone value =
  match value with
  | Null ->
      if Terms.exists (fun _ c -> Q.sign c < 0) cone.polynomial then refuse "cones: a negative coefficient";
      if relation = Above && not (is_positive cone) then refuse "cones: it may be 0"
  | List [ i; j; first; second ] ->
      let i = get_integer "splits" 0 last i and j = get_integer "splits" 0 last j in
      if i = j then refuse "cones: one variable";
      (* y_a is y_b and a rest *)
      let part a b =
        let above = add (form_of a) (form_of b) in
        let polynomial = counted (fun () -> substitute cone.polynomial (variable a) (above, unit_form, [])) () in
        let join g = if List.mem a g && not (List.mem b g) then b :: g else g in
        { polynomial; groups = List.map join cone.groups }
      in
      check_split relation last (part i j) first;
      check_split relation last (part j i) second
  | _ -> refuse "cones: expected null or [i, j, first, second]"

let check goal value =
  let last, cones = counted cones_of goal in
  let splits = get_list "splits" value in
  same_length "splits" cones splits;
  List.iter2 (check_split goal.relation last) cones splits
