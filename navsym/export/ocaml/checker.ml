(* A second checker of navsym's certificates, written from docs/certificates.md alone.

   checker FILE   one certificate; exit code 0 accepted, 1 refused, 2 outside
   checker        lines `id TAB certificate` from standard input; a line `id TAB answer` for each

   The answers are `accepted`, `refused: why` and `outside: what`. What the page does not specify, or what is not implemented here, is
   outside; it is never accepted. *)

open Text
open Tree
open Ball
open Value
open Goal
open Rules
open Statement

(* Kinds *)

(* The values of these keys, and the answers, which may be missing *)
let get_with_answers what keys value =
  let o = get_object what value in
  match List.assoc_opt "answers" o with
  | None -> (get_keys what keys value, List [])
  | Some answers -> (get_keys what keys (Object (List.remove_assoc "answers" o)), answers)

let get_names what value =
  let names = List.map (get_name what) (get_list what value) in
  if List.length (List.sort_uniq compare names) <> List.length names then refuse "%s: a name given twice" what;
  names

let check_identity value =
  match get_keys "identity" [ "kind"; "left"; "right"; "symbols" ] value with
  | [ _; left; right; symbols ] ->
      let names = get_names "symbols" symbols in
      let difference = subtract (get_tree "left" left) (get_tree "right" right) in
      Names.iter (fun s -> if not (List.mem s names) then no_symbols s) (Tree.symbols difference);
      shown "the sides differ" (Algebra.normal_form_vanishes difference)
  | _ -> assert false

let check_positivity value =
  match get_keys "positivity" [ "kind"; "expression"; "box"; "bits"; "cells" ] value with
  | [ _; expression; box; bits; cells ] ->
      let t = get_tree "expression" expression and bits = get_bits 20000 bits in
      let cells = get_integer "cells" 0 (most_cells bits) cells in
      at_precision bits (fun () ->
          let read (name, v) =
            match get_list name v with
            | [ low; high ] when is_name name ->
                let low = number_ball name (get_tree name low) in
                (name, { low; length = less (number_ball name (get_tree name high)) low; start = Z.zero; level = 0 })
            | _ -> refuse "box: expected [from, to] by name"
          in
          let sides = List.map read (get_object "box" box) in
          Names.iter (fun s -> if not (List.mem_assoc s sides) then no_symbols s) (Tree.symbols t);
          let settled cell =
            let balls = Map_of_names.map part_ball cell in
            match ball Whole (find balls) t with x -> is_above x | exception No_value -> false
          in
          let box = List.fold_left (fun m (n, s) -> Map_of_names.add n s m) Map_of_names.empty sides in
          bisect ~cells:(cells_allowed cells) ~names:(List.map fst sides) ~settled box)
  | _ -> assert false

let check_proof value =
  match get_with_answers "proof" [ "kind"; "statement"; "bits"; "witness"; "proofs" ] value with
  | [ _; statement; bits; witness; proofs ], answers ->
      at_precision (get_bits 20000 bits) (fun () ->
          let cases = read_statement answers statement in
          ignore (check_cases cases (read_numbers "witness" witness));
          let goals = List.concat_map (fun s -> List.map (goal_of s) s.goals) cases in
          prove_each "proofs" goals (get_list "proofs" proofs))
  | _ -> assert false

let fails value (t, relation) =
  match finite_ball value t with
  | None -> false
  | Some x -> (
      match relation with
      | Equal -> not (has_zero x)
      | Unequal -> is_exactly_zero x
      | Above -> sign_of x.hi <= 0
      | AtLeast -> is_below x)

let check_counterexample value =
  match get_with_answers "counterexample" [ "kind"; "statement"; "bits"; "point"; "zero" ] value with
  | [ _; statement; bits; point; zero ], answers ->
      at_precision (get_bits 200000 bits) (fun () ->
          let point = read_numbers "point" point in
          let cases = read_statement ~point answers statement in
          let found = check_cases cases point in
          match (zero, List.concat_map (fun (point, _, s) -> List.map (fun goal -> (point, goal)) s.goals) found) with
          | Null, _ ->
              let fails_in (_, value, s) = List.exists (fails value) s.goals in
              shown "the statement is not seen to fail" (List.exists fails_in found)
          | proof, [ (point, (t, (Above | Unequal))) ] -> prove (alone (put point t) Equal) proof
          | _ -> refuse "the relation allows 0")
  | _ -> assert false

(* Matrices of expressions in listed symbols *)

let get_matrix what names value =
  let read_entry v =
    let t = get_tree what v in
    Names.iter (fun s -> if not (List.mem s names) then no_symbols s) (Tree.symbols t);
    t
  in
  List.map (fun row -> List.map read_entry (get_list what row)) (get_list what value)

let check_width what n rows =
  if List.exists (fun row -> List.length row <> n) rows then refuse "%s: expected rows of %d entries" what n

(* The entries of M v *)
let apply_rows rows v = List.map (fun row -> Sum (zero :: List.map2 (fun a b -> Prod [ a; b ]) row v)) rows
let column j rows = List.map (fun row -> List.nth row j) rows

let check_exponential value =
  match get_keys "exponential" [ "kind"; "matrix"; "solution"; "variable"; "symbols" ] value with
  | [ _; matrix; solution; variable; symbols ] ->
      let others = get_names "symbols" symbols and t = get_name "variable" variable in
      if List.mem t others then refuse "a name given twice";
      let a = get_matrix "matrix" others matrix and x = get_matrix "solution" (t :: others) solution in
      let n = List.length a in
      if n = 0 || List.length x <> n then refuse "expected two square matrices of one size";
      check_width "matrix" n a;
      check_width "solution" n x;
      let must_vanish what t = shown what (Algebra.normal_form_vanishes t) in
      let check_column j =
        let v = column j x in
        List.iter2 (fun f g -> must_vanish "X' differs from A X" (subtract (Calculus.derive t f) g)) v (apply_rows a v);
        let unit i = if i = j then one else zero in
        List.iteri (fun i f -> must_vanish "X(0) differs from I" (subtract (put [ (t, zero) ] f) (unit i))) v
      in
      List.iter check_column (List.init n Fun.id)
  | _ -> assert false

(* The determinant of balls, by elimination with the pivot that is farthest from 0; no value where none is seen to differ from 0 *)
let rec determinant = function
  | [] -> ball_one
  | rows ->
      let distance row = (size (List.hd row)).lo in
      let best = List.fold_left (fun m row -> greatest m (distance row)) nought rows in
      let rec pick before = function
        | row :: l when compare_ends (distance row) best = 0 -> (List.length before, row, List.rev_append before l)
        | row :: l -> pick (row :: before) l
        | [] -> assert false
      in
      let k, pivot, others = pick [] rows in
      let reduce row =
        let c = over (List.hd row) (List.hd pivot) in
        List.map2 (fun x p -> less x (times c p)) (List.tl row) (List.tl pivot)
      in
      let rest = times (List.hd pivot) (determinant (List.map reduce others)) in
      if k land 1 = 1 then minus rest else rest

let check_rank value =
  match get_keys "rank" [ "kind"; "matrix"; "symbols"; "rank"; "point"; "rows"; "null" ] value with
  | [ _; matrix; symbols; rank; point; rows; null ] ->
      let names = get_names "symbols" symbols in
      let m = get_matrix "matrix" names matrix in
      let n = match m with row :: _ -> List.length row | [] -> refuse "matrix: expected a row" in
      let null = get_matrix "null" names null in
      check_width "matrix" n m;
      check_width "null" n null;
      let r = get_integer "rank" 0 n rank in
      let rows = List.map (get_integer "rows" 0 (List.length m - 1)) (get_list "rows" rows) in
      if List.length rows <> r || List.length null <> n - r then refuse "rank: another number of entries";
      let read (name, v) = (name, of_rational (get_number "point" v)) in
      let point = List.map read (get_object "point" point) in
      if List.length point <> List.length names || not (List.for_all (fun s -> List.mem_assoc s point) names) then
        refuse "point: expected every symbol";
      List.iter (fun v -> List.iter (fun t -> shown "M v does not vanish" (Algebra.normal_form_vanishes t)) (apply_rows m v)) null;
      let at t = match finite_ball (fun s -> List.assoc s point) t with Some x -> x | None -> refuse "no value at the point" in
      let square = List.map (fun i -> List.nth m i) rows @ null in
      let is_regular = match determinant (List.map (List.map at) square) with x -> not (has_zero x) | exception No_value -> false in
      shown "the rows and vectors may be dependent" is_regular
  | _ -> assert false

let rec check value =
  match List.assoc_opt "kind" (get_object "certificate" value) with
  | None -> refuse "expected the key kind"
  | Some kind -> (
      match get_text "kind" kind with
      | "identity" -> check_identity value
      | "positivity" -> check_positivity value
      | "proof" -> check_proof value
      | "counterexample" -> check_counterexample value
      | "condition" -> Condition.check value ~at_precision
      | "exponential" -> check_exponential value
      | "rank" -> at_precision 128 (fun () -> check_rank value)
      | "words" -> at_precision 128 (fun () -> Words.check value)
      | "sized" -> at_precision 128 (fun () -> Sized.check value)
      | "gap" | "sliver" -> Gap.check value
      | "touch" | "range" -> Gap.check_pieces value
      | "cones" -> Bounds.check_cones value ~at_precision
      | "design" -> Bounds.check_design value ~at_precision
      | "exclusion" -> Bounds.check_exclusion value ~at_precision
      | "observability" -> Observability.check value ~get_matrix ~check_width ~determinant
      | "all" -> (
          match get_keys "all" [ "kind"; "of" ] value with
          | [ _; List (_ :: _ as l) ] -> List.iter check l
          | _ -> refuse "of: expected a list of at least one certificate")
      | name -> outside "kind %s" name)

(* Answers *)

type answer = Accepted | Refusal of string | Not_here of string

let judge text =
  Algebra.forget ();
  precision := 96;
  match check (read_document text) with
  | () -> Accepted
  | exception Refused why -> Refusal why
  | exception Outside what -> Not_here what
  | exception Stack_overflow -> Refusal "too deep"
  | exception Out_of_memory -> Refusal "too large"
  | exception No_value -> Refusal "no value"
  | exception Nowhere -> Refusal "no value"
  | exception Z.Overflow -> Refusal "a number too large"
  | exception Division_by_zero -> Refusal "a division by 0"

let printed = function Accepted -> "accepted" | Refusal why -> "refused: " ^ why | Not_here what -> "outside: " ^ what

let judge_lines () =
  try
    while true do
      let line = input_line stdin in
      match String.index_opt line '\t' with
      | None -> Printf.printf "?\trefused: expected an id, a tab and a certificate\n%!"
      | Some i ->
          let text = String.sub line (i + 1) (String.length line - i - 1) in
          Printf.printf "%s\t%s\n%!" (String.sub line 0 i) (printed (judge text))
    done
  with End_of_file -> ()

let judge_file path =
  let channel = open_in_bin path in
  let answer = judge (really_input_string channel (in_channel_length channel)) in
  print_endline (printed answer);
  exit (match answer with Accepted -> 0 | Refusal _ -> 1 | Not_here _ -> 2)

let () =
  match Array.to_list Sys.argv with
  | [ _ ] -> judge_lines ()
  | [ _; path ] -> ( try judge_file path with Sys_error why -> prerr_endline why; exit 3)
  | _ -> prerr_endline "usage: checker [FILE]"; exit 3
